// One function a command: it declares the command's options on `app` and its callback. The commands
// of the second list need LibTorch and live in a second executable that the first one starts;
// evaluate, of which only a part does, is in both.
#pragma once

#include <CLI/CLI.hpp>

namespace mocaplm {

void add_synth(CLI::App& app);
void add_import(CLI::App& app);
void add_info(CLI::App& app);
void add_tokenize(CLI::App& app);
void add_generate(CLI::App& app);
void add_view(CLI::App& app);
void add_convert(CLI::App& app);
void add_render(CLI::App& app);
void add_gesture(CLI::App& app);
void add_query(CLI::App& app);
void add_filter(CLI::App& app);
void add_emulate(CLI::App& app);
void add_doctor(CLI::App& app);
void add_completion(CLI::App& app);
void add_man_page(CLI::App& app);

void add_train(CLI::App& app);
void add_classify(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_experiment(CLI::App& app);
void add_infill(CLI::App& app);
void add_interpolate(CLI::App& app);
void add_demo(CLI::App& app);
void add_torch_commands(CLI::App& app);

}  // namespace mocaplm
