// doctor: tables on the terminal and as JSON, in reasonable time.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::doctor_test {
namespace {

std::string value_of(const Json& table, const std::string& key, const std::string& first,
                     const std::string& second) {
  for (const Json& row : table["rows"])
    if (row[first] == key)
      return row[second].is_string() ? row[second].get<std::string>() : row[second].dump();
  return "";
}

TEST(Doctor, TellsTheMachineAndTheParts) {
  TemporaryFolder folder;
  const std::string json = (folder / "d.json").string();
  const Ran ran = run_mocaplm("doctor --seconds 0 --json '" + json + "'");
  ASSERT_EQ(ran.code, 0) << ran.text;
  const Json tables = load_json(json);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_GE(std::stoi(value_of(tables[0], "cores", "this machine", "value")), 1);
  EXPECT_TRUE(contains(value_of(tables[0], "memory", "this machine", "value"), "iB"));
  EXPECT_FALSE(
      value_of(tables[0], "instructions when generating", "this machine", "value").empty());
  for (const char* part : {"LibTorch", "three.js", "chromium"})
    EXPECT_TRUE(contains(ran.text, part)) << ran.text;
  // What is missing comes with what to do.
  for (const Json& row : tables[1]["rows"])
    if (row["found"] == "missing") {
      const std::string part = row["part"];
      bool advised = false;
      for (const Json& note : tables[1]["notes"])
        advised = advised || note.get<std::string>().rfind(part + ": ", 0) == 0;
      EXPECT_TRUE(advised) << part;
    }
}

TEST(Doctor, MeasuresAndReckonsAModel) {
  if (!fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch"))
    GTEST_SKIP() << "mocaplm-torch is not built here";
  TemporaryFolder folder;
  const std::string json = (folder / "d.json").string();
  const auto start = std::chrono::steady_clock::now();
  const Ran ran =
      run_mocaplm("doctor --seconds 0.5 --device cpu --threads 1 --json '" + json + "'");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_LT(took.count(), 60);  // on a busy machine; 3 s alone
  for (const char* part : {"tokens/s", "GFLOP/s", "a model for an hour", "--n-layer"})
    EXPECT_TRUE(contains(ran.text, part)) << part << "\n" << ran.text;
  EXPECT_EQ(load_json(json).size(), 3u);
}

TEST(Doctor, RefusesWhatCannotBe) {
  EXPECT_EQ(run_mocaplm("doctor --seconds 1000").code, 2);
  EXPECT_EQ(run_mocaplm("doctor --seconds 0 --json /proc/none/d.json").code, 3);
}

}  // namespace
}  // namespace mocaplm::doctor_test
