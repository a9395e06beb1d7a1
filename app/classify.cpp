// mocaplm classify: a classifier beside LDA and the majority class.
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "classify/train.h"

namespace mocaplm {

void add_classify(CLI::App& app) {
  CLI::App* classify = app.add_subcommand(
      "classify", "train and test a classifier beside LDA and the majority class");
  auto options = std::make_shared<ClassifyOptions>();
  auto json = std::make_shared<std::string>();
  classify->add_option("--model", options->model, "pre-trained model or training run folder")
      ->required();
  classify->add_option("--data", options->data, "labelled dataset folder")->required();
  classify->add_option("--out", options->out, "keep the classifier and its tables in this folder");
  classify->add_option("--split", options->split, "clips to test on")
      ->check(CLI::IsMember({"validation", "test"}))
      ->capture_default_str();
  classify->add_option("--json", *json, "also write the tables as JSON");
  add_machine_options(*classify, options->device, options->threads);
  bind_options(*classify->add_option_group("classifier"), options->config);
  classify->callback([options, json] {
    std::printf("%s\n", settings_json(options->config).dump().c_str());
    std::fflush(stdout);
    print_tables(classify_tables(mocaplm::classify(*options)), *json);
  });
}

}  // namespace mocaplm
