// mocaplm evaluate: bits per frame beside simple baselines; forecasts; long dances.
//
// Both executables have this command: forecasts and long dances need no LibTorch, and the light one
// hands only bits per frame on to the other.
#include "evaluate/evaluate.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/run.h"
#include "common/error.h"
#include "common/files.h"
#include "evaluate/generated/forecast.h"
#include "evaluate/generated/long_dances.h"
#include "generate/kernels/level.h"

namespace mocaplm {

namespace {

struct EvaluateCommand {
  CLI::App* app = nullptr;
  std::vector<std::filesystem::path> models;
  EvaluateOptions bits;
  ForecastOptions forecast;  // what all modes share is parsed into `bits` and `forecast`
  LongOptions dances;
  bool asks_forecast = false;
  double long_seconds = 0;
  std::string json;

  bool given(const std::string& option) const { return app->get_option(option)->count() > 0; }
};

const std::vector<std::string> kShared = {"--model",      "--data", "--split",   "--where",
                                          "--conditions", "--json", "--threads", "--engine"};

// Refuses options of another mode, which would do nothing.
void check_mode(const EvaluateCommand& command, std::vector<std::string> allowed,
                const std::string& why) {
  allowed.insert(allowed.end(), kShared.begin(), kShared.end());
  refuse_options_except(*command.app, allowed, why);
}

void fill(GeneratedOptions& options, const EvaluateCommand& command) {
  options.models = command.models;
  options.data = command.bits.data;
  options.split = command.bits.split;
  options.where = command.bits.where;
  options.conditions = command.bits.conditions;
  options.threads = command.bits.threads;
  options.seed_seconds = command.forecast.seed_seconds;
  options.sampling = command.forecast.sampling;
  if (!command.bits.engine.empty()) options.precision = command.bits.engine;
}

std::vector<Table> run_forecast(EvaluateCommand& command) {
  check_mode(command,
             {"--forecast", "--seed-seconds", "--horizons", "--fps", "--samples", "--windows",
              "--all-joints", "--temperature", "--top-k", "--top-p", "--seed"},
             " does nothing with --forecast");
  fill(command.forecast, command);
  return forecast_tables(command.forecast);
}

std::vector<Table> run_long(EvaluateCommand& command) {
  check_mode(command,
             {"--long", "--seed-seconds", "--dances", "--strategy", "--temperature", "--top-k",
              "--top-p", "--seed"},
             " does nothing with --long");
  if (command.models.empty()) throw UsageError("--model is required with --long");
  fill(command.dances, command);
  command.dances.seconds = command.long_seconds;
  return long_tables(command.dances);
}

std::vector<Table> run_bits(EvaluateCommand& command) {
  check_mode(command, {"--by", "--precision", "--device"},
             " needs --forecast or --long; bits per frame have no such option");
  if (command.models.size() != 1)
    throw UsageError(command.models.empty()
                         ? "--model is required (only --forecast does without)"
                         : "bits per frame are told of one --model; --forecast and --long "
                           "compare several");
#ifdef MOCAPLM_WITH_TORCH
  command.bits.model = command.models[0];
  return evaluate_tables(command.bits);
#else
  start_with_torch();
#endif
}

void run_evaluate(EvaluateCommand& command) {
  check_writable(command.json);
  print_tables(command.asks_forecast     ? run_forecast(command)
               : command.given("--long") ? run_long(command)
                                         : run_bits(command),
               command.json);
}

void add_bits_options(CLI::App& app, EvaluateOptions& options) {
  app.add_option("--by", options.by,
                 "a table for each value of this label, with baselines of its own");
  app.add_option("--precision", options.precision, "type of LibTorch's matrix products")
      ->check(one_of({"auto", "bf16", "f32"}))
      ->capture_default_str();
  CLI::Option* engine =
      app.add_option("--engine", options.engine,
                     "precision of the engine that generates; without --forecast and --long: "
                     "score with it instead of LibTorch")
          ->check(one_of(precision_names()));
  add_machine_options(app, options.device, options.threads);
  for (const char* torch : {"--precision", "--device"}) engine->excludes(app.get_option(torch));
}

void add_generated_options(CLI::App& app, EvaluateCommand& command) {
  ForecastOptions& forecast = command.forecast;
  CLI::Option* long_dances =
      app.add_option("--long", command.long_seconds,
                     "dances of so many seconds: drift, frozen frames, skating, roughness, beside "
                     "the data's")
          ->check(CLI::Range(1.0, 3600.0))
          ->check(BindOptions::finite());
  app.add_flag(
         "--forecast", command.asks_forecast,
         "forecasts in Aksan et al.'s protocol beside zero velocity and linear extrapolation; "
         "without --model these alone")
      ->excludes(long_dances);
  CLI::App& group = *app.add_option_group("generating", "of --forecast and --long");
  group
      .add_option("--seed-seconds", forecast.seed_seconds, "how much of a clip the model is shown")
      ->check(CLI::Range(0.01, 600.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  group.add_option("--horizons", forecast.horizons, "milliseconds, comma separated")
      ->delimiter(',')
      ->check(BindOptions::finite())
      ->capture_default_str();
  group.add_option("--fps", forecast.fps, "rate at which forecasts are compared")
      ->check(CLI::Range(1.0, 1000.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  group
      .add_option("--samples", forecast.samples,
                  "forecasts drawn of each window beside the greedy one")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  group.add_option("--windows", forecast.windows, "look at so many windows only, 0 for all")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  group.add_flag("--all-joints", forecast.all_joints,
                 "count all 15 joints of the protocol; those that a model lacks stay still");
  group.add_option("--dances", command.dances.dances, "long dances, each from another clip")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  bind_options(group, forecast.sampling);
}

}  // namespace

void add_evaluate(CLI::App& app) {
  CLI::App* evaluate = app.add_subcommand(
      "evaluate", "measure bits per frame beside baselines; forecasts; long dances");
  auto command = std::make_shared<EvaluateCommand>();
  command->app = evaluate;
  EvaluateOptions& options = command->bits;
  evaluate->add_option("--model", command->models,
                       "model or training run folder; several are compared by --forecast and "
                       "--long");
  evaluate
      ->add_option("--data", options.data,
                   "dataset folder; baselines are fitted on its training split")
      ->required();
  evaluate->add_option("--split", options.split, "clips to look at")
      ->check(one_of({"train", "validation", "test"}))
      ->capture_default_str();
  evaluate->add_option("--where", options.where, "only clips with label=value (repeatable)");
  evaluate->add_flag("--conditions,!--no-conditions", options.conditions,
                     "tell the model the clips' labels, if it knows conditions");
  add_json_option(*evaluate, command->json);
  add_bits_options(*evaluate, options);
  add_generated_options(*evaluate, *command);
  evaluate->callback([command] { run_evaluate(*command); });
}

}  // namespace mocaplm
