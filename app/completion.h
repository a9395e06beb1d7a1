// Completion for shells, made of the declared options: commands, options, values that are
// enumerated, files by their endings.
#pragma once

#include <string>
#include <vector>

#include "app/declarations.h"

namespace mocaplm {

// What files an option or a word in its place may name.
struct FileKind {
  bool any = false;                  // files at all
  bool folders = false;              // only folders
  std::vector<std::string> endings;  // "npz"; none: all files
};
// By the name of its value, and the endings that its help names.
FileKind file_kind(const DeclaredOption& option);

// Scripts that a shell sources.
std::string bash_completion(const std::vector<DeclaredCommand>& commands);
std::string zsh_completion(const std::vector<DeclaredCommand>& commands);

}  // namespace mocaplm
