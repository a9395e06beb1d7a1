// The parts of `mocaplm emulate`, each a subcommand of its own.
#pragma once

#include <CLI/CLI.hpp>

namespace mocaplm {

void add_emulate_fit(CLI::App& emulate);
void add_emulate_sample(CLI::App& emulate);
void add_emulate_test(CLI::App& emulate);

}  // namespace mocaplm
