#include "app/run.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "app/guide.h"
#include "app/options.h"
#include "app/parse_failure.h"
#include "app/read_options.h"
#include "app/torch_part.h"
#include "app/version.h"
#include "common/error.h"

namespace mocaplm {

namespace {

char** g_argv = nullptr;

int report(ExitCode code, const std::string& message) {
  print_remarks();
  std::fprintf(stderr, "mocaplm: %s\n", message.c_str());
  return static_cast<int>(code);
}

}  // namespace

void start_with_torch() {
  prepare_for_torch();
  const std::filesystem::path other = torch_part_path();
  ::execv(other.c_str(), g_argv);
  throw Error(ExitCode::internal, "cannot start " + other.string() +
                                      ", the part with LibTorch, which should lie beside this "
                                      "program; 'mocaplm doctor' says what to do");
}

void add_commands_with_torch(CLI::App& app) {
  const std::pair<const char*, const char*> commands[] = {
      {"train", "pre-train or fine-tune a model on a dataset"},
      {"classify", "train and test a classifier beside simple ones, or use a kept one"},
      {"experiment", "train and test the rows of a table; go on where it was cut off"},
      {"infill", "fill missing joints or frames of a clip with a masked model"},
      {"interpolate", "change a motion until its spectral features come near another's"},
      {"demo", "do all of it on procedural dances, in minutes"}};
  for (const auto& [name, help] : commands) {
    CLI::App* command = app.add_subcommand(name, help);
    command->allow_extras();
    command->prefix_command();
    command->set_help_flag();  // the other executable answers --help
    command->callback([] { start_with_torch(); });
  }
}

namespace {

// LibTorch says on many lines that there is no memory (RAM or the GPU's), as an error of its own.
bool is_out_of_memory(const std::string& message) {
  for (const char* part : {"not enough memory", "allocate memory", "out of memory"})
    if (message.find(part) != std::string::npos) return true;
  return false;
}

constexpr const char* kOutOfMemory =
    "out of memory: the input, model or batch is too large for this machine";

}  // namespace

int run(CLI::App& app, int argc, char** argv) {
  g_argv = argv;
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text, "print version, LibTorch, instruction set");
  group_commands(app);
  if (argc < 2) {
    std::fputs((app.help() + "\n").c_str(), stderr);
    return report(ExitCode::usage, "give a command");
  }
  try {
    app.parse(argc, argv);
    print_remarks();
    return static_cast<int>(ExitCode::ok);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return report(ExitCode::usage, parse_failure(app, argc, argv, error));
  } catch (const Error& error) {
    return report(error.code(), error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return report(ExitCode::data, error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    return report(ExitCode::data, kOutOfMemory);
  } catch (const std::exception& error) {
    if (is_out_of_memory(error.what())) return report(ExitCode::data, kOutOfMemory);
    return report(ExitCode::internal, std::string("internal error: ") + error.what());
  }
}

void add_machine_options(CLI::App& app, std::string& device, int& threads) {
  app.add_option("--device", device, "where to compute")
      ->check(one_of({"cpu", "cuda", "auto"}))
      ->capture_default_str();
  add_threads_option(app, threads);
}

void refuse_options_except(const CLI::App& app, const std::vector<std::string>& allowed,
                           const std::string& why) {
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0 &&
        std::find(allowed.begin(), allowed.end(), option->get_name()) == allowed.end())
      throw UsageError(option->get_name() + why);
  for (const CLI::App* group : app.get_subcommands([](const CLI::App*) { return true; }))
    refuse_options_except(*group, allowed, why);
}

void refuse_options(const CLI::App& app, const std::vector<std::string>& options,
                    const std::string& why) {
  for (const std::string& option : options)
    if (app.get_option(option)->count() > 0) throw UsageError(option + why);
}

void add_json_option(CLI::App& app, std::string& file) {
  app.add_option("--json", file, "also write the printed tables as JSON");
}

void print_table(const Table& table, const std::string& json_file) {
  std::fputs(table.text().c_str(), stdout);
  std::fflush(stdout);
  if (!json_file.empty()) save_json(json_file, table.json());
}

void print_tables(const std::vector<Table>& tables, const std::string& json_file) {
  Json all = Json::array();
  for (const Table& table : tables) {
    std::printf("%s\n", table.text().c_str());
    all.push_back(table.json());
  }
  std::fflush(stdout);
  if (!json_file.empty()) save_json(json_file, all);
}

}  // namespace mocaplm
