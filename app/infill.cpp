// mocaplm infill: missing joints or frames of a clip, filled by a masked model.
#include "infill/infill.h"

#include <memory>

#include "app/commands.h"
#include "app/generated.h"
#include "app/options.h"
#include "app/read_options.h"
#include "common/error.h"
#include "common/files.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"
#include "viewer/page.h"

namespace mocaplm {

namespace {

struct InfillCommand {
  InfillOptions options;
  MotionReading read;
  std::string clip, out = "filled", json;
  std::vector<std::string> joints, labels;
};

std::string missing_text(const InfillResult& result, const InfillCommand& command) {
  const double fps = result.original.fps;
  return (command.joints.empty() ? "all joints" : join(command.joints, ", ")) + ", frames " +
         std::to_string(result.first) + " to " + std::to_string(result.last - 1) + " (" +
         format_fixed(static_cast<double>(result.first) / fps, 2) + " to " +
         format_fixed(static_cast<double>(result.last) / fps, 2) + " s)";
}

Table infill_table(const InfillResult& result, const InfillCommand& command) {
  Table table("missing: " + missing_text(result, command),
              {"degrees from the clip itself", "mean", "most"});
  table.digits({-1, 2, 1});
  const auto row = [&](const std::string& name, const FillError& error) {
    table.row({name, error.mean, error.most});
  };
  row("filled", result.error);
  if (result.line) row("linear interpolation", *result.line);
  row("the bins alone", result.bins);
  table.note(std::to_string(result.tokens) + " tokens filled in " +
             std::to_string(command.options.fill.rounds) + " rounds, at " +
             format_number(result.original.fps) + " frames per second");
  table.note("files: " + join(generated_files(command.out), " "));
  if (result.procedural) table.note("the model was trained on procedural dances");
  return table;
}

void write(const InfillResult& result, const InfillCommand& command, const Table& table) {
  for (const std::string& file : generated_files(command.out)) {
    if (std::filesystem::path(file).extension() != ".html") {
      write_clip(file, result.filled);
      continue;
    }
    Page page;
    page.title = "A filled gap";
    page.highlight_name = "filled joints";
    if (result.procedural) page.note = "trained on procedural dances made by this program";
    page.motions.push_back(
        {"clip", result.original, result.joints, {}, "The clip: " + command.clip});
    page.motions.push_back({"filled",
                            result.filled,
                            result.joints,
                            {},
                            "Missing were " + missing_text(result, command)});
    page.tables.push_back(table);
    page.settings = {{"model", command.options.model.string()}, {"clip", command.clip}};
    write_page(file, page);
  }
}

void run(InfillCommand& command) {
  InfillOptions& options = command.options;
  options.joints = parse_joints(command.joints);
  options.labels = parse_labels(command.labels);
  if (options.to > 0 && options.to <= options.from) throw UsageError("--to must be above --from");
  std::vector<std::filesystem::path> written = {command.json};
  for (const std::string& file : generated_files(command.out)) written.push_back(file);
  const MotionInput input = find_motion(command.clip, command.read);
  check_outputs(written, {input.file()});
  for (const std::filesystem::path& file : written) check_writable(file);
  options.clip = read_motion(input, command.read).clip;
  const InfillResult result = infill(options);
  const Table table = infill_table(result, command);
  write(result, command, table);
  print_table(table, command.json);
}

}  // namespace

void add_infill(CLI::App& app) {
  CLI::App* infill =
      app.add_subcommand("infill", "fill missing joints or frames of a clip with a masked model");
  auto command = std::make_shared<InfillCommand>();
  InfillOptions& options = command->options;
  infill->add_option("--model", options.model, "masked model or training run folder")->required();
  infill->add_option("CLIP", command->clip, kMotionFile)->required();
  infill
      ->add_option("--joints", command->joints,
                   "missing joints or groups, e.g. left_arm; without it all and the root's path")
      ->delimiter(',');
  const auto add_seconds = [&](const char* name, double& value, const char* help) {
    infill->add_option(name, value, help)
        ->check(CLI::Range(0.0, 1e6))
        ->check(BindOptions::finite())
        ->capture_default_str();
  };
  add_seconds("--from", options.from, "second in which the gap begins");
  add_seconds("--to", options.to, "second in which it ends, 0 for the clip's end");
  infill->add_option("--label", command->labels, "a condition, name=value")->delimiter(',');
  infill->add_option("--out", command->out, "writes OUT.npz, OUT.bvh and OUT.html")
      ->capture_default_str();
  infill->add_option("--precision", options.precision, "type of the matrix products")
      ->check(one_of({"auto", "bf16", "f32"}))
      ->capture_default_str();
  add_json_option(*infill, command->json);
  add_machine_options(*infill, options.device, options.threads);
  bind_options(*infill->add_option_group("filling"), options.fill);
  add_read_options(*infill, command->read);
  infill->callback([command] { run(*command); });
}

}  // namespace mocaplm
