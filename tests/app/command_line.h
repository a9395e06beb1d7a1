// Runs the built program and catches what it says.
#pragma once

#include <string>

#include "support/run_program.h"

namespace mocaplm {

// `arguments` as a shell takes them. Memory is limited to 2 GiB.
inline Ran run_mocaplm(const std::string& arguments) {
  return run_program("ulimit -v 2097152; " MOCAPLM_BINARY_DIR "/mocaplm " + arguments);
}

}  // namespace mocaplm
