// What --version says.
#pragma once

#include <string>

namespace mocaplm {

// Version, instruction set, threads, LibTorch: a line each. Each of the two executables has one.
std::string version_text();

}  // namespace mocaplm
