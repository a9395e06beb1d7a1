// What help tells beside the declared options: the walk, groups of commands, two examples of each.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mocaplm {

struct Example {
  std::string words;  // after the program's name; they run as written
  std::string what;   // they do
};

struct CommandGuide {
  std::string command;  // "train", "emulate fit"
  std::string group;    // of the general help; empty for the part of a command
  std::vector<Example> examples;
};

// In the order of the general help.
const std::vector<CommandGuide>& command_guides();
// Null where there is none: a hidden command.
const CommandGuide* guide_of(const std::string& command);

// The walk in order: what a newcomer types first.
const std::vector<Example>& walk_examples();

// Gives every command of the guide its group; commands that it does not name stay as they are.
void group_commands(CLI::App& app);

}  // namespace mocaplm
