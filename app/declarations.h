// The commands and options as they are declared, in a form of their own: what help, completion and
// the man page are made of.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "app/guide.h"
#include "common/json.h"

namespace mocaplm {

struct DeclaredOption {
  std::vector<std::string>
      names;          // "--k", "-k", of a flag also "--no-k"; none: a word in its place
  std::string place;  // of such a word: "CLIP", "CLIP..." of many
  // What it takes: "N" and "X" are numbers, "NAME" one of its choices, "FILE", "FOLDER", "PATH"
  // (one of both), "OUT" the beginning of names of files, "TEXT" others; "" for a flag.
  std::string value;
  std::vector<std::string> choices;
  std::string range;    // "1 to 96"
  std::string initial;  // the default
  std::string help;
  std::string group;  // "sampling"; "" for the command's own
  bool required = false, many = false;

  // "1 to 96; default 4"
  std::string limits() const;
};

struct DeclaredCommand {
  std::string name;  // "train", "emulate fit"
  std::string group, help;
  std::vector<DeclaredOption> options;
  std::vector<std::string> parts;  // commands of its own: "fit"
  std::vector<Example> examples;

  // "mocaplm generate --model FOLDER [OPTIONS]"
  std::string usage() const;
};

// Endings of files that a help text names: "npz".
std::vector<std::string> endings_in(const std::string& help);

// The commands of a command, hidden ones too. (CLI11 keeps groups of options as commands without a
// name, and a hidden command is in no group.)
std::vector<const CLI::App*> commands_of(const CLI::App& app);
std::vector<const CLI::App*> option_groups_of(const CLI::App& app);
const CLI::App* find_command(const CLI::App& app, const std::string& name);  // null: none
inline bool is_hidden(const CLI::App& command) {
  return command.get_group().empty();
}

// One command; `name` with all words.
DeclaredCommand declaration(const CLI::App& app, const std::string& name);
// All that are not hidden, parts after their command.
std::vector<DeclaredCommand> declarations(const CLI::App& app);

// Those and the ones of the program with LibTorch, which is asked, in the order of the guide. Where
// it does not answer, `note` says why and its commands have no options.
std::vector<DeclaredCommand> all_declarations(const CLI::App& app, std::string* note = nullptr);

Json to_json(const std::vector<DeclaredCommand>& commands);
// Throws DataError naming `place` when it is not that.
std::vector<DeclaredCommand> declarations_from_json(const Json& json, const std::string& place);

}  // namespace mocaplm
