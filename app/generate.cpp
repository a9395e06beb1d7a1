// mocaplm generate: a dance from a few joints, a continuation, or from nothing.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/generated.h"
#include "app/options.h"
#include "common/error.h"
#include "common/files.h"
#include "common/progress.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

struct GenerateCommand {
  std::string model, prompt, out = "generated", json;
  std::vector<std::string> joints, labels;
  Labels named;
  GenerateRequest request;
  std::int64_t count = 1;
  int threads = 0;
};

std::string numbered(const GenerateCommand& command, std::int64_t i) {
  return command.count == 1 ? command.out : command.out + "-" + std::to_string(i + 1);
}

// What is read must not be written over, and what cannot be written is said before the work.
void check_out(const GenerateCommand& command) {
  std::error_code missing;
  for (std::int64_t i = 0; i < command.count; ++i)
    for (const std::string& file : generated_files(numbered(command, i))) {
      if (!command.prompt.empty() && std::filesystem::equivalent(file, command.prompt, missing))
        throw UsageError("--out would replace the prompt " + command.prompt +
                         ": give another --out");
      check_writable(file);
    }
  check_writable(command.json);
}

void run_generate(GenerateCommand& command) {
  GenerateRequest& request = command.request;
  request.labels = parse_labels(command.labels);
  for (const auto& [name, value] : command.named)
    if (!value.empty()) request.labels[name] = value;
  request.joints = parse_joints(command.joints);
  check_out(command);
  set_engine_threads(command.threads);
  const std::string place = resolve_model(command.model).string();
  Generator generator(load_model(command.model), place);
  if (!command.prompt.empty()) request.prompt = read_clip(command.prompt, {});
  const std::int64_t seed = request.sampling.seed;
  for (std::int64_t i = 0; i < command.count; ++i) {
    request.sampling.seed = seed + i;
    const std::string stem = numbered(command, i);
    Progress bar("generate", 0, "frames");
    const GenerateResult result =
        generator.generate(request, [&](std::size_t done, std::size_t) { bar.update(done); });
    bar.finish();
    write_generated(stem, generator, request, result, command.model, command.prompt);
    print_table(generated_table(generator, request, result, stem), command.json);
  }
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App* generate =
      app.add_subcommand("generate", "generate a dance from a few joints and conditions");
  auto command = std::make_shared<GenerateCommand>();
  generate->add_option("--model", command->model, "model or training run folder")->required();
  generate->add_option("--prompt", command->prompt,
                       "clip (.npz, .pkl, .bvh); without it the model starts from nothing");
  generate
      ->add_option("--joints", command->joints,
                   "joints of the prompt that are kept, e.g. right_arm,pelvis; without it the "
                   "prompt is continued")
      ->delimiter(',');
  for (const char* label : {"genre", "dancer", "music", "choreography", "situation"})
    generate->add_option(std::string("--") + label, command->named[label],
                         std::string("condition: ") + label);
  generate->add_option("--label", command->labels, "any other condition, name=value")
      ->delimiter(',');
  generate->add_option("--seconds", command->request.seconds, "length")
      ->check(CLI::Range(0.05, 3600.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  generate
      ->add_option("--prompt-seconds", command->request.prompt_seconds,
                   "use only the first seconds of the prompt, 0 for all")
      ->check(CLI::Range(0.0, 3600.0))
      ->check(BindOptions::finite())
      ->capture_default_str();
  generate->add_option("--out", command->out, "writes OUT.npz, OUT.bvh and OUT.html")
      ->capture_default_str();
  generate->add_option("--count", command->count, "how many, with seeds seed, seed + 1, ...")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  generate->add_option("--threads", command->threads, "threads, 0 for all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  generate->add_option("--json", command->json, "also write the printed table as JSON");
  bind_options(*generate->add_option_group("sampling"), command->request.sampling);
  generate->callback([command] { run_generate(*command); });
}

}  // namespace mocaplm
