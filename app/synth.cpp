// mocaplm synth: labelled procedural dances to try everything out on.
#include "motion/synth.h"

#include <cstdio>

#include "app/commands.h"
#include "app/options.h"
#include "motion/import.h"

namespace mocaplm {

namespace {

struct SynthCommand {
  SynthConfig config;
  std::string out, json;
  std::int64_t threads = 0;
  bool overwrite = false;

  void run() const {
    const Dataset dataset = write_dances(config, out, overwrite, threads);
    const Table table = split_table(dataset);
    print_table(table, json);
    std::printf(
        "\n%s\nWritten to %s. These dances are procedural: rules made them, nobody danced "
        "them.\n",
        label_table(dataset).text().c_str(), out.c_str());
  }
};

}  // namespace

void add_synth(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("synth", "make labelled procedural dances in AIST++'s naming");
  const auto state = std::make_shared<SynthCommand>();
  command->add_option("--out", state->out, "folder of the dataset")->required();
  bind_options(*command, state->config);
  command->add_flag("--overwrite", state->overwrite, "replace the dataset that is there");
  add_threads_option(*command, state->threads, "dances made at a time; 0: one for each core");
  add_json_option(*command, state->json);
  command->callback([state] { state->run(); });
}

}  // namespace mocaplm
