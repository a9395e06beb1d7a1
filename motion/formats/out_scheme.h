// On which program's skeleton a motion is written: motion/formats/skeletons.h says what they are.
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

enum class OutScheme { smpl, mixamo, unity, unreal, vrm, rokoko, cmu };

// "smpl", "mixamo", ...: what --skeleton takes, in the enum's order.
const std::vector<std::string>& out_scheme_names();
OutScheme out_scheme_of(const std::string& name);  // throws UsageError for other names
std::string to_string(OutScheme scheme);

}  // namespace mocaplm
