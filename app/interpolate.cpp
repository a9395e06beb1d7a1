// mocaplm interpolate: a motion between two, by gradient descent on spectral features.
#include "spectral/interpolate/interpolate.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "app/spectral_files.h"
#include "common/error.h"
#include "common/files.h"
#include "spectral/interpolate/evaluation.h"

namespace mocaplm {

namespace {

struct InterpolateCommand {
  std::string a, b;
  MotionReading read;
  InterpolateConfig config;
  SpectralFiles files{"interpolated", "", "", ""};
  InterpolateEvaluation evaluation;
};

void evaluate(const CLI::App& app, InterpolateCommand& command) {
  refuse_options_except(app,
                        {"--evaluate", "--data", "--pairs", "--seed", "--seconds", "--split",
                         "--json", "--fps", "--steps", "--rate", "--weight", "--from-hz", "--to-hz",
                         "--stft-window", "--stft-hop", "--coefficients"},
                        " does not go with --evaluate, which compares all targets and writes a "
                        "table");
  if (command.evaluation.dataset.empty())
    throw UsageError("--evaluate draws pairs of a dataset's clips: give --data DATASET");
  check_writable(command.files.json);
  command.evaluation.config = command.config;
  print_tables(evaluate_interpolate(command.evaluation), command.files.json);
}

Page page_of(const InterpolateCommand& command, const InterpolateResult& result,
             const Table& table) {
  Page page;
  page.title = "A motion between two";
  page.motions.push_back({"original", result.original, {}, {}, "The first clip: " + command.a});
  page.motions.push_back({"interpolated", result.result, {}, {}, table.title()});
  page.motions.push_back({"target", result.target, {}, {}, "The second clip: " + command.b});
  page.tables.push_back(table);
  add_settings(page, settings_json(command.config));
  return page;
}

void run(const CLI::App& app, InterpolateCommand& command) {
  if (!command.evaluation.label.empty()) return evaluate(app, command);
  refuse_options(app, {"--data", "--pairs", "--seed", "--seconds", "--split"},
                 " goes with --evaluate LABEL");
  if (command.b.empty())
    throw UsageError("give two motions, A and B, or --data DATASET --evaluate LABEL");
  const MotionInput first = find_motion(command.a), second = find_motion(command.b);
  if (first.dataset && second.dataset)
    refuse_read_options(command.read, " is for motion files, and both are clips of a dataset");
  command.files.check({first.file().string(), second.file().string()});
  const Clip a = read_motion(first, command.read).clip;
  const Clip b = read_motion(second, command.read).clip;
  const InterpolateResult result = interpolate(a, b, command.config);
  Table table = interpolate_table(result, command.config);
  const std::vector<std::string> files = command.files.write(
      result.result, page_of(command, result, table),
      {{"original", result.original}, {"target", result.target}, {"interpolated", result.result}},
      command.config.stft_window, command.config.hop());
  table.note("settings: " + settings_json(command.config).dump());
  table.note("files: " + join(files, " "));
  print_table(table, command.files.json);
}

}  // namespace

void add_interpolate(CLI::App& app) {
  CLI::App* command_line = app.add_subcommand(
      "interpolate", "change a motion until its spectral features come near another's");
  auto command = std::make_shared<InterpolateCommand>();
  command_line->add_option("A", command->a,
                           kMotionFile + std::string(": the motion to begin with"));
  command_line->add_option("B", command->b,
                           "the same, of the motion whose features are the target");
  command_line
      ->add_option("--out", command->files.out,
                   "stem of the .npz, .bvh and .html written, or one of these files")
      ->capture_default_str();
  command_line->add_option("--plot", command->files.plot,
                           "DCT coefficients of all three as an .svg, too");
  command_line->add_option("--spectrogram", command->files.spectrogram,
                           "spectrograms of all three as an .svg, too");
  add_json_option(*command_line, command->files.json);
  bind_options(*command_line, command->config);
  add_read_options(*command_line, command->read);
  InterpolateEvaluation& evaluation = command->evaluation;
  command_line->add_option("--evaluate", evaluation.label,
                           "instead of A and B: similarities and roughness of pairs of --data's "
                           "clips that differ in this label, for all targets");
  command_line->add_option("--data", evaluation.dataset, "--evaluate: dataset folder");
  bind_options(*command_line, evaluation.pairs);
  command_line->callback([command_line, command] { run(*command_line, *command); });
}

}  // namespace mocaplm
