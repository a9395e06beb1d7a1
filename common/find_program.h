// Other programs of this machine.
#pragma once

#include <filesystem>
#include <string>

namespace mocaplm {

// The first file of this name on the PATH that may be run, or an empty path.
std::filesystem::path find_program(const std::string& name);

}  // namespace mocaplm
