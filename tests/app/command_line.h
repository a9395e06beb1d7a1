// Runs the built program, or any, and catches what it says.
#pragma once

#include <string>

#include "support/run_program.h"

namespace mocaplm {

// `arguments` as a shell takes them. Memory is limited to 2 GiB.
inline Ran run_program(const std::string& program, const std::string& arguments) {
  return run_shell("ulimit -v 2097152; '" + program + "' " + arguments);
}

inline Ran run_mocaplm(const std::string& arguments) {
  return run_program(MOCAPLM_BINARY_DIR "/mocaplm", arguments);
}

}  // namespace mocaplm
