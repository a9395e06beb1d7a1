// Running a command line: parse, call, and turn every failure into a message and an exit code.
#pragma once

#include <CLI/CLI.hpp>

namespace mocaplm {

// 0 ok, 1 internal, 2 usage, 3 bad input or data.
int run(CLI::App& app, int argc, char** argv);

// Names the commands of the executable with LibTorch (mocaplm-torch, beside this one); using one
// replaces this process by it, as git does with its own commands.
void add_commands_with_torch(CLI::App& app);
// Does so now, for a command of which only a part needs LibTorch.
[[noreturn]] void start_with_torch();

}  // namespace mocaplm
