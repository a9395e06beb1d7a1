// The commands of `mocaplm gesture` that have files of their own.
#pragma once

#include <CLI/CLI.hpp>

namespace mocaplm {

void add_gesture_play(CLI::App& gesture);
void add_gesture_juggle(CLI::App& gesture);

}  // namespace mocaplm
