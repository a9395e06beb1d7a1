// mocaplm evaluate: bits per frame beside simple baselines.
#include "evaluate/evaluate.h"

#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "common/files.h"
#include "generate/kernels/level.h"

namespace mocaplm {

void add_evaluate(CLI::App& app) {
  CLI::App* evaluate =
      app.add_subcommand("evaluate", "bits per frame of a model beside simple baselines");
  auto options = std::make_shared<EvaluateOptions>();
  auto json = std::make_shared<std::string>();
  evaluate->add_option("--model", options->model, "model or training run folder")->required();
  evaluate
      ->add_option("--data", options->data,
                   "dataset folder; baselines are fitted on its training split")
      ->required();
  evaluate->add_option("--split", options->split, "clips to score")
      ->check(CLI::IsMember({"train", "validation", "test"}))
      ->capture_default_str();
  evaluate->add_option("--where", options->where, "only clips with label=value (repeatable)");
  evaluate->add_option("--by", options->by,
                       "a table for each value of this label, with baselines of its own");
  evaluate->add_flag("--conditions,!--no-conditions", options->conditions,
                     "tell the model the clips' labels, if it knows conditions");
  evaluate->add_option("--precision", options->precision, "type of the matrix products")
      ->check(CLI::IsMember({"auto", "bf16", "f32"}))
      ->capture_default_str();
  CLI::Option* engine =
      evaluate
          ->add_option(
              "--engine", options->engine,
              "score with the engine that generates, in this precision, instead of LibTorch")
          ->check(CLI::IsMember(precision_names()));
  evaluate->add_option("--json", *json, "also write the tables as JSON");
  add_machine_options(*evaluate, options->device, options->threads);
  for (const char* torch : {"--precision", "--device"})
    engine->excludes(evaluate->get_option(torch));
  evaluate->callback([options, json] {
    check_writable(*json);
    print_tables(evaluate_tables(*options), *json);
  });
}

}  // namespace mocaplm
