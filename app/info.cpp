// mocaplm info: what a file or folder of this program's world is.
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/described.h"
#include "app/options.h"

namespace mocaplm {

namespace {

struct InfoCommand {
  std::vector<std::string> paths;
  std::string json;

  void run() const {
    Json all = Json::array();
    for (const std::string& path : paths)
      for (const Table& table : describe_path(path)) {
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
  command->add_option("PATH", state->paths, "any file or folder that this program reads or writes")
      ->required();
  add_json_option(*command, state->json);
  command->callback([state] { state->run(); });
}

}  // namespace mocaplm
