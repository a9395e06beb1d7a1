// mocaplm experiment: a table of the thesis, or another comparison, from its file.
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "common/files.h"
#include "experiments/runner.h"
#include "motion/dataset.h"

namespace mocaplm {

namespace {

struct ExperimentCommand {
  std::filesystem::path file;
  ExperimentOptions options;
  double minutes = 0;
  std::vector<std::string> set;
};

void run(const ExperimentCommand& command) {
  const Experiment experiment = load_experiment(command.file, command.minutes, command.set);
  print_tables(run_experiment(experiment, command.options), "");
  std::printf("also in %s\n", (command.options.out / "table.json").c_str());
}

}  // namespace

void add_experiment(CLI::App& app) {
  CLI::App* experiment = app.add_subcommand(
      "experiment", "train and test the rows of a table; go on where it was cut off");
  auto command = std::make_shared<ExperimentCommand>();
  ExperimentOptions& options = command->options;
  experiment
      ->add_option("FILE", command->file, "what to compare, e.g. configs/thesis/table-4-4.json")
      ->required();
  experiment->add_option("--data", options.data, "dataset folder that every row is tested on")
      ->required();
  experiment->add_option("--other-data", options.other_data,
                         "dataset folder of the rows that are pre-trained on another one");
  experiment->add_option("--out", options.out, "folder of the runs and their table")->required();
  experiment->add_option("--split", options.split, "clips to test on")
      ->check(one_of({"validation", "test"}))
      ->capture_default_str();
  experiment
      ->add_option("--minutes", command->minutes,
                   "time for training each row, 0 for as long as the file says")
      ->check(CLI::Range(0.0, 100000.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  experiment
      ->add_option("--set", command->set,
                   "another setting in every row, section.key=value: model.n_layer=2")
      ->type_size(1)
      ->allow_extra_args(false);
  add_machine_options(*experiment, options.device, options.threads);
  experiment->callback([command] { run(*command); });
}

}  // namespace mocaplm
