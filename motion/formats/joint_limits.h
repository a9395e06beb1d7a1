// How large a skeleton of a file may be: more is a broken file, or no skeleton.
#pragma once

#include <cstddef>

namespace mocaplm {

inline constexpr std::size_t kMaxJoints = 4096, kMaxJointDepth = 256;

}  // namespace mocaplm
