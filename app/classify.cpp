// mocaplm classify: a classifier beside LDA and the majority class, or what a kept one says of
// clips.
#include <filesystem>
#include <memory>

#include "app/classification_page.h"
#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "classify/predict.h"
#include "classify/train.h"
#include "common/error.h"
#include "common/files.h"
#include "viewer/open.h"

namespace mocaplm {

namespace {

struct ClassifyCommand {
  ClassifyOptions train;
  std::vector<std::string> clips;
  MotionReading read;
  std::string json, page;
};

void run_classify(const CLI::App& app, const ClassifyCommand& command) {
  const ClassifyOptions& train = command.train;
  check_writable(command.json);
  if (!command.clips.empty()) {
    std::vector<std::string> allowed = {"--model",     "CLIP",     "--json",
                                        "--precision", "--device", "--threads"};
    allowed.insert(allowed.end(), read_option_names().begin(), read_option_names().end());
    refuse_options_except(app, allowed,
                          " cannot be given with clips: a kept classifier tells their labels, and "
                          "is trained without them (--data DATASET)");
    print_table(predict_table({train.model, command.clips, command.read, train.config.precision,
                               train.device, train.threads}),
                command.json);
    return;
  }
  if (train.data.empty())
    throw UsageError("give --data DATASET to train a classifier, or clips to classify with one");
  refuse_read_options(command.read, " is for clips to classify: --data reads no motion files");
  if (!std::filesystem::is_directory(train.out)) check_writable(train.out);
  if (!command.page.empty()) check_page_path(command.page);
  check_writable(command.page);
  std::printf("%s\n", settings_json(train.config).dump().c_str());
  std::fflush(stdout);
  const ClassifyResult result = classify(train);
  print_tables(classify_tables(result), command.json);
  if (command.page.empty()) return;
  write_page(command.page, classification_page(train, result));
  std::printf("page: %s\n", command.page.c_str());
}

}  // namespace

void add_classify(CLI::App& app) {
  CLI::App* classify = app.add_subcommand(
      "classify", "train and test a classifier beside simple ones, or use a kept one");
  auto command = std::make_shared<ClassifyCommand>();
  ClassifyOptions& train = command->train;
  classify
      ->add_option("--model", train.model,
                   "pre-trained model or training run folder; for clips a kept classifier")
      ->required();
  classify->add_option("CLIP", command->clips,
                       kMotionFiles + std::string("or dataset folders: a kept classifier tells "
                                                  "their labels"));
  classify->add_option("--data", train.data, "labelled dataset folder to train and test on");
  classify->add_option("--out", train.out, "keep the classifier and its tables in this folder");
  classify->add_option("--split", train.split, "clips to test on")
      ->check(one_of({"validation", "test"}))
      ->capture_default_str();
  add_json_option(*classify, command->json);
  classify->add_option("--page", command->page,
                       "also write a page with plots and the clips that it gets wrong, .html");
  add_machine_options(*classify, train.device, train.threads);
  bind_options(*classify->add_option_group("classifier"), train.config);
  add_read_options(*classify, command->read);
  classify->callback([classify, command] { run_classify(*classify, *command); });
}

}  // namespace mocaplm
