// mocaplm render: a clip as a picture or a film.
#include "render/render.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "common/error.h"
#include "common/files.h"
#include "motion/inputs.h"

namespace mocaplm {

namespace {

struct RenderCommand {
  std::string clip, dataset_clip, out, json;
  MotionReading read;
  RenderConfig config;
  std::int64_t threads = 0;

  void run() const {
    check_render(out, config);
    check_writable(out);
    check_writable(json);
    const std::vector<std::string> chosen =
        dataset_clip.empty() ? std::vector<std::string>() : std::vector<std::string>{dataset_clip};
    const std::vector<MotionInput> found = find_motions({clip}, chosen, read);
    if (found.size() != 1)
      throw UsageError(clip + " holds " + std::to_string(found.size()) +
                       " clips: choose one with --clip");
    check_outputs({out, json}, files_of(found));
    const Clip motion = read_motion(found[0], read).clip;
    const std::int64_t pictures = render_clip(motion, out, config, threads);
    Table table("", {"rendered", "value"});
    table.row({"file", out});
    table.row({"clip", found[0].text});
    table.row({"seconds of motion", motion.seconds()});
    table.row({"pictures", pictures});
    table.row({"size", std::to_string(config.width) + " x " + std::to_string(config.height)});
    if (found[0].dataset && found[0].dataset->procedural)
      table.note("a procedural dance: rules made it, nobody danced it");
    print_table(table, json);
  }
};

}  // namespace

void add_render(CLI::App& app) {
  CLI::App* render = app.add_subcommand("render", "draw a clip as a .png, .mp4 or .gif");
  const auto command = std::make_shared<RenderCommand>();
  render
      ->add_option("CLIP", command->clip,
                   kMotionFile + std::string(", or a dataset folder with --clip"))
      ->required();
  render
      ->add_option("--out", command->out,
                   "the picture (.png) or film (.mp4, .gif: made by the program ffmpeg)")
      ->required();
  bind_options(*render, command->config);
  render->add_option("--clip", command->dataset_clip, "this clip of the dataset folder")
      ->type_name("NAME");
  add_read_options(*render, command->read);
  add_threads_option(*render, command->threads, "frames drawn at a time; 0: one for each core");
  add_json_option(*render, command->json);
  render->callback([command] { command->run(); });
}

}  // namespace mocaplm
