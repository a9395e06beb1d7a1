// mocaplm import: motion files become a dataset.
#include "motion/import.h"

#include <cstdio>

#include "app/commands.h"
#include "app/options.h"
#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

struct ImportCommand {
  ImportConfig config;
  ImportJob job;
  std::string out, json;
  bool append = false, overwrite = false;

  void run() {
    job.out = out;
    job.existing = append ? Existing::append : overwrite ? Existing::replace : Existing::refuse;
    const ImportReport report = import_motion(config, job);
    std::fputs(split_table(report.dataset).text().c_str(), stdout);
    if (!report.dataset.label_names().empty())
      std::printf("\n%s", label_table(report.dataset).text().c_str());
    if (!report.limbs.empty()) std::printf("\n%s", report.limbs.table().text().c_str());
    std::printf("\n%s", report.figures.table().text().c_str());
    print_notes(report);
    if (!json.empty()) save_json(json, report_json(report));
    if (!report.broken.empty())
      throw DataError(in_file(out),
                      std::to_string(report.broken.size()) + " of " +
                          std::to_string(report.imported + report.broken.size()) +
                          " files were broken and left out (named above); the dataset "
                          "holds the others");
  }

  void print_notes(const ImportReport& report) const {
    std::printf("\n%zu clips imported into %s.\n", report.imported, out.c_str());
    if (report.ignored > 0)
      std::printf("%zu other files in the folders were ignored.\n", report.ignored);
    for (const auto& copies : report.duplicates)
      std::printf("The same motion, kept in one group: %s\n", join(copies, ", ").c_str());
    for (const std::string& warning : report.warnings) std::printf("Note: %s.\n", warning.c_str());
    for (const std::string& line : remark_lines(report)) std::printf("Note: %s.\n", line.c_str());
    for (const std::string& line : left_out_lines(report))
      std::printf("Left out: %s\n", line.c_str());
    std::fflush(stdout);
  }
};

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("import", "make a dataset of AMASS .npz, AIST++ .pkl and .bvh files");
  const auto state = std::make_shared<ImportCommand>();
  command->add_option("SRC", state->job.sources, "files, or folders searched to the bottom")
      ->required();
  command->add_option("--out", state->out, "folder of the dataset")->required();
  bind_options(*command, state->config);
  // Help and completion would take them for files, by their words.
  command->get_option("--label-from-dir")->type_name("LABEL");
  command->get_option("--label-regex")->type_name("REGEX");
  command->get_option("--group")->type_name("REGEX|FILE");
  command->get_option("--map")->type_name("FILE");
  command->get_option("--body")->type_name("FILE");
  // As the other commands call them.
  command->add_option("--bvh-map", state->config.map, "the same as --map")
      ->type_name("FILE")
      ->excludes("--map");
  command->add_option("--source-fps", state->config.fps, "the same as --fps")
      ->check(CLI::Range(0.001, 10000.0))
      ->check(BindOptions::finite())
      ->excludes("--fps");
  CLI::Option* append =
      command->add_flag("--append", state->append, "add to the dataset that is there");
  command->add_flag("--overwrite", state->overwrite, "replace the dataset that is there")
      ->excludes(append);
  command->add_flag("--strict", state->job.strict,
                    "stop at the first broken file and write nothing");
  add_threads_option(*command, state->job.threads, "files read at a time; 0: one for each core");
  add_json_option(*command, state->json);
  command->callback([state] { state->run(); });
}

}  // namespace mocaplm
