// The program with LibTorch, mocaplm-torch, seen from the light one: where it lies, what it
// answers.
#pragma once

#include <filesystem>
#include <string>

#include "common/json.h"

namespace mocaplm {

// Beside this program, there or not.
std::filesystem::path torch_part_path();

// Environment that the other program reads while it loads.
void prepare_for_torch();

struct TorchAnswer {
  bool installed = false;  // the file is there
  std::string failure;     // why there is no answer; empty when there is one
  Json json;
};

// Runs it with a hidden command ("about", "declarations", "measure ...") that prints one line of
// JSON, and waits.
TorchAnswer ask_torch_part(const std::string& arguments);

}  // namespace mocaplm
