// mocaplm generate: a dance from a few joints, a continuation, or from nothing.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/frame_stream.h"
#include "app/generated.h"
#include "app/options.h"
#include "app/read_options.h"
#include "common/error.h"
#include "common/files.h"
#include "model/directory.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

struct GenerateCommand {
  std::string model, prompt, out = "generated", json, stream, precision = "bf16";
  std::vector<std::string> joints, labels;
  Labels named;
  MotionReading read;
  GenerateRequest request;
  std::int64_t count = 1, batch = 16;
  int threads = 0;
};

EngineOptions engine_options(const GenerateCommand& command) {
  return {named_precision(command.precision), command.threads,
          std::min(command.count, command.batch)};
}

std::string numbered(const GenerateCommand& command, std::int64_t i) {
  return command.count == 1 ? command.out : command.out + "-" + std::to_string(i + 1);
}

// What is read must not be written over, and what cannot be written is said before the work.
void check_out(const GenerateCommand& command) {
  std::vector<std::filesystem::path> written = {command.json};
  for (std::int64_t i = 0; i < command.count; ++i)
    for (const std::string& file : generated_files(numbered(command, i))) written.push_back(file);
  if (!command.prompt.empty())
    check_outputs(written, {find_motion(command.prompt, command.read).file()});
  else
    refuse_read_options(command.read, " is for the file of a --prompt");
  for (const std::filesystem::path& file : written) check_writable(file);
  FrameStream::check(command.stream);
}

// Writes the files; returns what is told of them.
Table keep(const GenerateCommand& command, const Generator& generator,
           const GenerateRequest& request, const GenerateResult& result, std::int64_t index) {
  const std::string stem = numbered(command, index);
  write_generated(stem, generator, request, result, command.model, command.prompt);
  return generated_table(generator, request, result, stem);
}

// One table is a JSON object, several are a list. Standard output belongs to the frames where they
// go there.
void tell(const GenerateCommand& command, const std::vector<Table>& tables) {
  if (command.stream != "-")
    for (const Table& table : tables) std::fputs(table.text().c_str(), stdout);
  if (command.json.empty()) return;
  Json list = Json::array();
  for (const Table& table : tables) list.push_back(table.json());
  save_json(command.json, command.count == 1 ? list[0] : list);
}

void run_generate(GenerateCommand& command) {
  GenerateRequest& request = command.request;
  request.labels = parse_labels(command.labels);
  for (const auto& [name, value] : command.named)
    if (!value.empty()) request.labels[name] = value;
  request.joints = parse_joints(command.joints);
  check_out(command);
  const std::string place = resolve_model(command.model).string();
  if (load_description(command.model).masked())
    throw UsageError(place + " is a masked model: it fills gaps of a clip, see mocaplm infill");
  Generator generator(load_model(command.model), place, engine_options(command));
  if (!command.prompt.empty()) request.prompt = read_one_motion(command.prompt, command.read);
  const std::int64_t seed = request.sampling.seed;
  FrameStream stream(generator.tokenizer().config().fps, static_cast<std::size_t>(command.count),
                     command.stream);
  std::vector<Table> tables;
  for (std::int64_t first = 0; first < command.count; first += command.batch) {
    std::vector<GenerateRequest> requests;
    for (std::int64_t i = first; i < std::min(command.count, first + command.batch); ++i) {
      request.sampling.seed = seed + i;
      requests.push_back(request);
    }
    const auto results = generator.generate(requests, [&](GeneratedFrame frame) {
      frame.dance += static_cast<std::size_t>(first);
      stream.tell(frame);
    });
    for (std::size_t i = 0; i < results.size(); ++i)
      tables.push_back(
          keep(command, generator, requests[i], results[i], first + static_cast<std::int64_t>(i)));
  }
  stream.finish();
  tell(command, tables);
}

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App* generate = app.add_subcommand(
      "generate", "continue a clip, fill in its open joints, or dance from nothing");
  auto command = std::make_shared<GenerateCommand>();
  generate->add_option("--model", command->model, "model or training run folder")->required();
  generate->add_option("--prompt", command->prompt,
                       kMotionFile + std::string("; without it the model starts from nothing"));
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
  generate->add_option("--seconds", command->request.seconds, "length of what is generated")
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
  generate
      ->add_option("--batch", command->batch,
                   "dances of --count that are decoded side by side; each is the same alone")
      ->check(CLI::Range(std::int64_t{1}, kMaxSequences))
      ->capture_default_str();
  generate
      ->add_option("--precision", command->precision,
                   "of the weights: f32, bf16 (half the memory), int8 (a quarter, fastest)")
      ->check(one_of(precision_names()))
      ->capture_default_str();
  generate->add_option("--stream", command->stream,
                       "file for the frames, a line of JSON each as soon as it is there; - for the "
                       "terminal or a pipe");
  add_threads_option(*generate, command->threads);
  add_json_option(*generate, command->json);
  bind_options(*generate->add_option_group("sampling"), command->request.sampling);
  add_read_options(*generate, command->read);
  generate->callback([command] { run_generate(*command); });
}

}  // namespace mocaplm
