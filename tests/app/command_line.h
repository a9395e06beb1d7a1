// Runs the built program, or any, and catches what it says.
#pragma once

#include <gtest/gtest.h>

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

// Runs it and expects the exit code, and that it says `part`.
inline void expect_run(const std::string& arguments, int code, const std::string& part) {
  const Ran ran = run_mocaplm(arguments);
  EXPECT_EQ(ran.code, code) << arguments << "\n" << ran.text;
  EXPECT_NE(ran.text.find(part), std::string::npos)
      << arguments << "\n\"" << part << "\" is not in\n"
      << ran.text;
}

}  // namespace mocaplm
