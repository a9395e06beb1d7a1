// mocaplm emulate test: emulated motions beside unseen real ones.
#include <memory>

#include "app/emulate.h"
#include "app/options.h"
#include "common/files.h"
#include "emulator/evaluation/plots.h"
#include "emulator/evaluation/tables.h"

namespace mocaplm {

namespace {

struct EmulateTestCommand {
  EvaluationOptions options;
  std::string out, json;

  void run() const {
    check_writable(json);
    if (!out.empty()) check_writable(std::filesystem::path(out) / "report.html");
    const Evaluation evaluation = evaluate_emulation(options, !out.empty());
    const std::vector<Table> tables = evaluation_tables(evaluation);
    if (!out.empty()) write_report(out, evaluation, tables);
    print_tables(tables, json);
  }
};

}  // namespace

void add_emulate_test(CLI::App& emulate) {
  CLI::App* command = emulate.add_subcommand(
      "test", "fit schemes to some clips and test what they simulate against unseen others");
  const auto state = std::make_shared<EmulateTestCommand>();
  EvaluationOptions& options = state->options;
  command->add_option("DATASET", options.data, "a dataset's folder")->required();
  bind_options(*command, options);
  bind_options(*command->add_option_group("motions", "how clips become sequences of postures"),
               options.landmarks);
  bind_options(*command->add_option_group("alignment", "in time"), options.align);
  bind_options(*command->add_option_group("schemes", "of all schemes that are tested"),
               options.options);
  command->add_option("--out", state->out, "also write a report with plots into this folder");
  add_json_option(*command, state->json);
  command->callback([state] { state->run(); });
}

}  // namespace mocaplm
