#include "bench/collect.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/temporary_folder.h"

namespace mocaplm::bench::collect_test {
namespace {

BenchRun run_of(const std::string& text) {
  return read_run(parse_json(text, "run.json"), "run.json");
}

Result result_of(const std::string& name, double value, const std::string& unit = "MB/s") {
  Result result;
  result.name = name;
  result.value = value;
  result.unit = unit;
  return result;
}

TEST(BenchResult, ReadsTheAgreedFormAndLeavesOtherKeysAlone) {
  const BenchRun run = run_of(
      R"({"bench": "decode", "kernels": "avx512", "results": [
          {"name": "A", "value": 2100.0, "unit": "tokens/s", "limit": 4300, "limit_name": "memory",
           "ratio": 0.49, "goal": 0.5, "prompt_tokens_per_second": 3},
          {"name": "B", "value": 16000, "unit": "tokens/s", "goal": 15000, "goal_on": "value"}]})");
  EXPECT_EQ(run.bench, "decode");
  ASSERT_EQ(run.results.size(), 2u);
  EXPECT_EQ(run.results[0].reached(), false);
  EXPECT_EQ(run.results[1].reached(), true);
  EXPECT_FALSE(run.results[1].limit.has_value());
}

TEST(BenchResult, RefusesAnotherFormByItsPlace) {
  for (const std::string text :
       {R"({"results": []})", R"({"bench": "x"})", R"({"bench": "x", "results": 1})",
        R"({"bench": "x", "results": [{"name": "a", "unit": "s"}]})",
        R"({"bench": "x", "results": [{"name": "a", "unit": "s", "value": "1"}]})",
        R"({"bench": "x", "results": [{"name": "a", "unit": "s", "value": 1, "goal_on": "x"}]})"}) {
    try {
      run_of(text);
      ADD_FAILURE() << text;
    } catch (const DataError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("run.json", 0), 0u) << error.what();
    }
  }
}

TEST(BenchResult, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  Result result = result_of("start", 4.5, "ms");
  result.goal = 50;
  result.goal_on_value = result.less_is_better = true;
  write_results(folder / "r.json", "startup", {result});
  const BenchRun run = read_run(load_json(folder / "r.json"), "r.json");
  EXPECT_EQ(run.bench, "startup");
  EXPECT_EQ(result_json(run.results.at(0)), result_json(result));
  EXPECT_EQ(run.results[0].reached(), true);
}

TEST(BenchResult, IsNamedAfterTheProgram) {
  EXPECT_EQ(bench_name("/a/b/import_bench"), "import");
  EXPECT_EQ(bench_name("other"), "other");
}

TEST(Collect, TakesMediansOfEachFigure) {
  std::vector<BenchRun> runs;
  for (const double value : {10.0, 1000.0, 12.0, 11.0}) {
    Result result = result_of("parse", value);
    if (value < 100) result.ratio = value / 10;
    runs.push_back({"import", {result, result_of("other", 1)}});
  }
  const std::vector<Collected> all = collect(runs);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].result.value, 11.5);
  EXPECT_EQ(all[0].result.ratio, 1.1);  // of the three that have one
  EXPECT_EQ(all[0].runs, 4u);
  EXPECT_EQ(all[0].least, 10);
  EXPECT_EQ(all[0].most, 1000);
  EXPECT_EQ(all[1].result.name, "other");
}

TEST(Collect, PutsAPeerBesideItsOwn) {
  Result ours = result_of("A, bf16", 1800, "tokens/s"), other = result_of("AB", 5, "tokens/s");
  Result peer = result_of("training A, plain PyTorch", 250, "tokens/s");
  peer.peer_of = "train/A";
  peer.goal = 7;
  const std::vector<Collected> all = collect({{"train", {ours, other}}, {"pytorch", {peer}}});
  ASSERT_EQ(all.size(), 4u);  // A, A beside the peer, AB, the peer
  EXPECT_EQ(all[1].result.name, "A, bf16");
  EXPECT_EQ(all[1].result.ratio, 7.2);
  EXPECT_EQ(all[1].result.reached(), true);
  EXPECT_EQ(all[2].result.name, "AB");
  EXPECT_FALSE(all[3].result.reached().has_value());
}

TEST(Collect, WritesATableAndTheMachine) {
  Result result = result_of("file to clip", 12345.6);
  result.limit = 20000;
  result.limit_name = "reading";
  result.ratio = 0.617;
  result.goal = 0.7;
  const Json machine = machine_json(), versions{{"mocaplm", "1.2"}};
  EXPECT_GT(machine["cores"].get<int>(), 0);
  EXPECT_GT(machine["memory_gib"].get<double>(), 0);
  const std::vector<Collected> all = collect({{"import", {result}}});
  const std::string table = collected_markdown(all, machine, versions);
  EXPECT_NE(table.find("| import: file to clip | 12,346 MB/s | 20,000, reading | 0.617 | 0.700, "
                       "**missed** |"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("Median of 1 run on "), std::string::npos);
  EXPECT_NE(table.find("mocaplm 1.2."), std::string::npos);
  const Json json = collected_json(all, machine, versions);
  EXPECT_EQ(json["results"][0]["bench"], "import");
  EXPECT_EQ(json["results"][0]["reached"], false);
  EXPECT_EQ(json["results"][0]["value"], 12345.6);
}

}  // namespace
}  // namespace mocaplm::bench::collect_test
