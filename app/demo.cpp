// mocaplm demo: the whole walk on procedural dances, in minutes.
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/walk.h"

namespace mocaplm {

void add_demo(CLI::App& app) {
  CLI::App* demo = app.add_subcommand("demo", "do all of it on procedural dances, in minutes");
  auto options = std::make_shared<WalkOptions>();
  demo->add_option("--out", options->out, "folder to fill; an earlier demo there is replaced")
      ->capture_default_str();
  demo->add_option("--genre", options->genre, "genre of the generated dance")
      ->capture_default_str();
  demo->add_option("--dancer", options->dancer,
                   "dancer of the generated dance (default: the first of the genre)");
  demo->add_option("--minutes", options->minutes,
                   "time for all training together; a time, not a count of steps, so two demos "
                   "differ a little")
      ->check(CLI::Range(0.05, 600.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  demo->add_option("--seconds", options->seconds, "length of the generated dance")
      ->check(CLI::Range(0.5, 60.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  demo->add_option("--seed", options->seed, "seed of dances, weights and choices")
      ->check(CLI::Range(0, 2147483647))
      ->capture_default_str();
  add_machine_options(*demo, options->device, options->threads);
  demo->callback([options] { walk(*options); });
}

}  // namespace mocaplm
