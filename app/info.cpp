// mocaplm info: what a file or folder of this program's world is.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/described.h"
#include "app/read_options.h"

namespace mocaplm {

namespace {

struct InfoCommand {
  std::vector<std::string> paths;
  std::string json;
  MotionReading read;

  void run() const {
    const bool reads = std::any_of(paths.begin(), paths.end(), [](const std::string& path) {
      return is_motion_file(split_part(parse_clip_range(path).clip).file);
    });
    if (!reads) refuse_read_options(read, " has no effect: no motion file is given");
    Json all = Json::array();
    for (const std::string& path : paths)
      for (const Table& table : describe_named(path, read)) {
        if (!all.empty()) std::fputc('\n', stdout);
        std::fputs(table.text().c_str(), stdout);
        all.push_back(table.json());
      }
    std::fflush(stdout);
    if (!json.empty()) save_json(json, all);
  }
};

}  // namespace

void add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "say what a file or folder of this program is");
  const auto state = std::make_shared<InfoCommand>();
  command
      ->add_option("PATH", state->paths,
                   "any file or folder that this program reads or writes; of a motion "
                   "also FILE:from-to, FILE#PART and DATASET#CLIP")
      ->required();
  add_read_options(*command, state->read);
  add_json_option(*command, state->json);
  command->callback([state] { state->run(); });
}

}  // namespace mocaplm
