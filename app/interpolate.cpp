// mocaplm interpolate: a motion between two, by gradient descent on spectral features.
#include "spectral/interpolate/interpolate.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/spectral_files.h"
#include "spectral/clip_range.h"

namespace mocaplm {

namespace {

struct InterpolateCommand {
  std::string a, b;
  InterpolateConfig config;
  SpectralFiles files{"interpolated", "", "", ""};
};

void run(InterpolateCommand& command) {
  command.files.check({parse_clip_range(command.a).clip, parse_clip_range(command.b).clip});
  const Clip a = read_clip_range(command.a, nullptr).clip;
  const Clip b = read_clip_range(command.b, nullptr).clip;
  const InterpolateResult result = interpolate(a, b, command.config);
  Table table = interpolate_table(result, command.config);
  Page page;
  page.title = "A motion between two";
  page.motions.push_back({"original", result.original, {}, {}, "The first clip: " + command.a});
  page.motions.push_back({"interpolated", result.result, {}, {}, table.title()});
  page.motions.push_back({"target", result.target, {}, {}, "The second clip: " + command.b});
  page.tables.push_back(table);
  const Json settings = settings_json(command.config);
  add_settings(page, settings);
  const std::vector<std::string> files = command.files.write(
      result.result, page,
      {{"original", result.original}, {"target", result.target}, {"interpolated", result.result}},
      command.config.stft_window, command.config.hop());
  table.note("settings: " + settings.dump());
  table.note("files: " + join(files, " "));
  print_table(table, command.files.json);
}

}  // namespace

void add_interpolate(CLI::App& app) {
  CLI::App* command_line = app.add_subcommand(
      "interpolate", "change a motion until its spectral features come near another's");
  auto command = std::make_shared<InterpolateCommand>();
  command_line
      ->add_option("A", command->a, "motion file to begin with, FILE:from-to for a part (seconds)")
      ->required();
  command_line->add_option("B", command->b, "motion file whose features are the target")
      ->required();
  command_line
      ->add_option("--out", command->files.out,
                   "stem of the .npz, .bvh and .html written, or one of these files")
      ->capture_default_str();
  command_line->add_option("--plot", command->files.plot,
                           "DCT coefficients of all three as an .svg, too");
  command_line->add_option("--spectrogram", command->files.spectrogram,
                           "spectrograms of all three as an .svg, too");
  command_line->add_option("--json", command->files.json, "write the table as JSON, too");
  bind_options(*command_line, command->config);
  command_line->callback([command] { run(*command); });
}

}  // namespace mocaplm
