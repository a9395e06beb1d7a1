// mocaplm filter: a motion rebuilt from some of its frequencies.
#include "spectral/filter.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "app/spectral_files.h"
#include "common/error.h"

namespace mocaplm {

namespace {

constexpr std::int64_t kHannFrames = 16, kHannHop = 8;  // of the spectrogram

struct FilterCommand {
  std::string clip;
  MotionReading read;
  FilterConfig config;
  SpectralFiles files{"filtered", "", "", ""};
};

void run(const CLI::App& app, FilterCommand& command) {
  if (command.config.keep == "low" && app.get_option("--from-hz")->count() > 0)
    throw UsageError("--from-hz goes with --keep band: the low frequencies begin at 0");
  const MotionInput input = find_motion(command.clip, command.read);
  command.files.check({input.file().string()});
  const Clip clip = read_motion(input, command.read).clip;
  const FilterResult result = filter_clip(clip, command.config);
  Table table = filter_table(clip, result, command.config);
  Page page;
  page.title = "Some frequencies of a motion";
  page.motions.push_back({"original", clip, {}, {}, "The clip: " + command.clip});
  page.motions.push_back({"filtered", result.filtered, {}, {}, table.title()});
  page.tables.push_back(table);
  Json settings = settings_json(command.config);
  if (command.config.keep == "low") settings.erase("from_hz");
  add_settings(page, settings);
  const std::vector<std::string> files = command.files.write(
      result.filtered, page, {{"original", clip}, {"filtered", result.filtered}}, kHannFrames,
      kHannHop);
  table.note("settings: " + settings.dump());
  table.note("files: " + join(files, " "));
  print_table(table, command.files.json);
}

}  // namespace

void add_filter(CLI::App& app) {
  CLI::App* filter =
      app.add_subcommand("filter", "rebuild a motion from its low frequencies or a band of them");
  auto command = std::make_shared<FilterCommand>();
  filter->add_option("CLIP", command->clip, kMotionFile)->required();
  filter
      ->add_option("--out", command->files.out,
                   "stem of the .npz, .bvh and .html written, or one of these files")
      ->capture_default_str();
  filter->add_option("--plot", command->files.plot, "DCT coefficients of both as an .svg, too");
  filter->add_option("--spectrogram", command->files.spectrogram,
                     "spectrograms of both as an .svg, too");
  add_json_option(*filter, command->files.json);
  bind_options(*filter, command->config);
  add_read_options(*filter, command->read);
  filter->callback([filter, command] { run(*filter, *command); });
}

}  // namespace mocaplm
