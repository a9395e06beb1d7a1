// bench_collect --out DIR [--version NAME=VERSION]... FILE...: the JSON of benchmarks, each several
// times, becomes DIR/results.json and DIR/table.md.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/collect.h"
#include "common/error.h"
#include "common/files.h"

int main(int argc, char** argv) {
  using namespace mocaplm;
  CLI::App app("puts the results of benchmarks together", "bench_collect");
  std::string out;
  std::vector<std::string> files, given;
  app.add_option("--out", out, "folder for results.json and table.md")->required();
  app.add_option("--version", given, "NAME=VERSION of what was measured")->allow_extra_args(false);
  app.add_option("FILE", files, "what the benchmarks wrote with --json")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    Json versions{{"Compiler", __VERSION__}, {"LibTorch", MOCAPLM_TORCH_VERSION}};
    for (const std::string& version : given) {
      const std::size_t equals = version.find('=');
      if (equals == std::string::npos)
        throw UsageError("--version " + version + ", expected NAME=VERSION");
      versions[version.substr(0, equals)] = version.substr(equals + 1);
    }
    std::vector<bench::BenchRun> runs;
    for (const std::string& file : files) {
      try {
        runs.push_back(bench::read_run(load_json(file), file));
      } catch (const DataError& error) {
        std::fprintf(stderr, "bench_collect: left out: %s\n", error.what());
      }
    }
    const std::vector<bench::Collected> all = bench::collect(runs);
    if (all.empty()) throw DataError(in_file(out), "no file holds results");
    const Json machine = bench::machine_json();
    save_json(out + "/results.json", bench::collected_json(all, machine, versions));
    const std::string table = bench::collected_markdown(all, machine, versions);
    write_file(out + "/table.md", table);
    std::fputs(table.c_str(), stdout);
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_collect: %s\n", error.what());
    return static_cast<int>(error.code());
  }
}
