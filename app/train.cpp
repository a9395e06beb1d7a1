// mocaplm train: pre-train on a dataset, fine-tune with --from, go on with --resume.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/training_page.h"
#include "app/training_samples.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "train/range_test.h"
#include "train/trainer.h"
#include "viewer/plot.h"

namespace mocaplm {

namespace {

struct TrainCommand {
  TrainOptions options;
  std::string config_file, from;
  bool range_test = false;
  RangeTestConfig range;
  SampleConfig samples;
  RunConfig given;  // what the command line says; only options that were used count
};

// A resumed run keeps its settings; options that would change them are refused, not ignored.
void check_resume(const CLI::App& app) {
  refuse_options_except(
      app, {"--out", "--resume", "--data", "--device", "--threads", "--sample-seconds"},
      " cannot be given with --resume: a run goes on with its own settings "
      "(settings.json); start another one with --from");
}

void run_range_test(const TrainCommand& command) {
  const RangeTestResult result = range_test(command.options, command.range);
  Plot plot;
  plot.title = "Learning-rate range test";
  plot.x_label = "learning rate";
  plot.y_label = "loss, nats a token";
  plot.log_x = true;
  plot.series.resize(3);
  plot.series[0].name = "each step";
  plot.series[0].line = false;
  plot.series[1].name = "smoothed";
  plot.series[2].name = "proposed";
  plot.series[2].line = false;
  for (std::size_t i = 0; i < result.rates.size(); ++i) {
    plot.series[0].points.push_back({result.rates[i], result.losses[i], ""});
    plot.series[1].points.push_back({result.rates[i], result.smooth[i], ""});
    if (i + 1 == result.rates.size() || result.rates[i + 1] > result.proposed)
      if (plot.series[2].points.empty())
        plot.series[2].points.push_back({result.rates[i], result.smooth[i], "proposed"});
  }
  const auto svg = command.options.out / "range_test.svg";
  write_file(svg, plot_svg(plot));
  print_table(range_test_table(result), "");
  std::printf("curve: %s, numbers: range_test.json beside it\n", svg.c_str());
}

// A run that is done is not lost for a page.
void write_curves(const std::filesystem::path& out) {
  try {
    write_page(out / "training.html", training_page(out));
    std::printf("curves: %s\n", (out / "training.html").c_str());
  } catch (const Error& error) {
    std::fprintf(stderr, "note: the page with the curves was not written: %s\n", error.what());
  }
}

void run_train(const CLI::App& app, TrainCommand& command) {
  TrainOptions& options = command.options;
  if (options.resume) check_resume(app);
  if (!command.range_test)
    for (const char* option : {"--range-steps", "--range-low", "--range-high"})
      if (app.get_option(option)->count() > 0)
        throw UsageError(std::string(option) + " is for --range-test");
  if (!command.config_file.empty()) options.config = load_run_config(command.config_file);
  overlay_options(app, command.given.tokenizer, options.config.tokenizer);
  overlay_options(app, command.given.pieces, options.config.pieces);
  overlay_options(app, command.given.model, options.config.model);
  overlay_options(app, command.given.train, options.config.train);
  if (!command.from.empty()) options.from = command.from;
  if (!options.resume && options.data.empty())
    throw UsageError("--data is required (a folder made by 'mocaplm import' or 'mocaplm synth')");
  if (!options.resume) std::printf("%s\n", to_json(options.config).dump(2).c_str());
  std::fflush(stdout);
  if (command.range_test) return run_range_test(command);
  TrainingSamples samples(options.out, command.samples, options.threads);
  options.on_validation = [&samples](const Validated& now) { samples.look(now); };
  const TrainResult result = train(options);
  std::printf(
      "%lld parameters, %lld steps in %s, %.0f tokens/s, waited %.1f s for data; best validation "
      "%.2f bits/frame\nmodel: %s\n",
      static_cast<long long>(result.parameters), static_cast<long long>(result.steps),
      format_duration(result.seconds).c_str(), result.tokens_per_second, result.seconds_waiting,
      result.best_bits_per_frame, result.model.c_str());
  write_curves(options.out);
}

}  // namespace

void add_train(CLI::App& app) {
  CLI::App* train = app.add_subcommand("train", "pre-train or fine-tune a model on a dataset");
  auto command = std::make_shared<TrainCommand>();
  train->add_option("--config", command->config_file, "settings file, see configs/");
  train->add_option("--data", command->options.data, "dataset folder");
  train->add_option("--out", command->options.out, "folder of the run")->required();
  train->add_option("--from", command->from, "model or training run folder to fine-tune");
  train->add_flag("--resume", command->options.resume, "go on with the run in --out");
  train->add_flag(
      "--range-test", command->range_test,
      "instead of training raise the learning rate step by step, propose one, and write "
      "range_test.json and range_test.svg to --out");
  bind_options(*train->add_option_group("range test"), command->range);
  bind_options(*train->add_option_group("samples"), command->samples);
  add_machine_options(*train, command->options.device, command->options.threads);
  bind_options(*train->add_option_group("tokenizer"), command->given.tokenizer);
  bind_options(*train->add_option_group("pieces", "of words, with --architecture flat"),
               command->given.pieces);
  bind_options(*train->add_option_group("model"), command->given.model);
  bind_options(*train->add_option_group("training"), command->given.train);
  train->callback([train, command] { run_train(*train, *command); });
}

}  // namespace mocaplm
