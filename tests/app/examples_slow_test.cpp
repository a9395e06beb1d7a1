// Every example of every command's help runs as it is written, on tiny data with the names that the
// examples use.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <sstream>

#include "app/command_line.h"
#include "common/files.h"
#include "common/find_program.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "common/text.h"
#include "support/refusal.h"

namespace fs = std::filesystem;

namespace mocaplm::examples_slow_test {
namespace {

const Json kTiny = {{"tokenizer", {{"bins", 60}, {"joints", {"thesis"}}}},
                    {"model", {{"n_layer", 1}, {"n_head", 2}, {"n_embd", 16}, {"block_size", 512}}},
                    {"train",
                     {{"steps", 4},
                      {"batch_size", 2},
                      {"micro_batch", 2},
                      {"warmup", 1},
                      {"validate_every", 4},
                      {"validation_windows", 2},
                      {"save_every", 4}}}};

// Strokes to the right, each to another place.
std::string strokes() {
  std::ostringstream csv;
  csv << "trajectory,time,x,y\n";
  for (int k = 0; k < 16; ++k)
    for (int i = 0; i <= 40; ++i) {
      const double t = i / 40.0, s = t * t * (3 - 2 * t);
      csv << k << ',' << t * (0.8 + 0.02 * k) << ',' << s * (0.3 + 0.02 * (k % 5)) << ','
          << s * (0.1 + 0.03 * (k % 3)) + 0.02 * std::sin(3.1 * t * (1 + 0.01 * k)) << '\n';
    }
  return csv.str();
}

class Examples : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!fs::exists(MOCAPLM_BINARY_DIR "/mocaplm-torch")) return;
    base_ = std::make_unique<TemporaryFolder>();
    const fs::path at = base_->path();
    must("synth --genres WA,HO --dancers 2 --choreographies 3 --seconds 4 --out dances");
    std::vector<fs::path> clips;
    for (const auto& entry : fs::directory_iterator(at / "dances" / "clips"))
      clips.push_back(entry.path());
    std::sort(clips.begin(), clips.end());
    fs::copy_file(clips.front(), at / "dance.npz");
    must("filter '" + clips.back().string() + "' --to-hz 8 --out clip.bvh");
    for (const char* genre : {"waack", "house"}) fs::create_directories(at / "mocap" / genre);
    fs::copy_file(at / "clip.bvh", at / "mocap/waack/a.bvh");
    for (std::size_t i = 0; i < 4; ++i)
      fs::copy_file(clips[i], at / "mocap/house" / clips[i].filename());
    write_configs(at / "configs");
    must("train --config configs/small.json --data dances --out run");
    must("train --from run --config configs/finetune.json --data dances --out tuned");
    must("train --config configs/small.json --objective masked --data dances --out masked");
    must("classify --model run --data dances --labels genre --steps 2 --out classifier");
    must("emulate fit dances --where genre=waack --out waack.json");
    write_file(at / "strokes.csv", strokes());
    must("gesture fit strokes.csv --out strokes.json");
  }
  static void TearDownTestSuite() { base_.reset(); }
  void SetUp() override {
    if (!base_) GTEST_SKIP() << "mocaplm-torch is not built here";
  }

  static void write_configs(const fs::path& folder) {
    write_file(folder / "small.json", kTiny.dump());
    write_file(folder / "finetune.json", Json{{"train", kTiny["train"]}}.dump());
    const Json experiment = {
        {"title", "tiny"},
        {"config", kTiny},
        {"rows",
         {{{"name", "a"}}, {{"name", "b"}, {"change", {{"model", {{"position", "absolute"}}}}}}}}};
    write_file(folder / "thesis" / "table-4-4.json", experiment.dump());
  }

  // In a folder, the program found as a user finds it; no limit of memory.
  static Ran run_in(const fs::path& folder, const std::string& words) {
    return run_shell("cd '" + folder.string() +
                     "' && PATH='" MOCAPLM_BINARY_DIR "':$PATH && mocaplm " + words);
  }
  static void must(const std::string& words) {
    const Ran ran = run_in(base_->path(), words);
    ASSERT_EQ(ran.code, 0) << words << "\n" << ran.text;
  }

  // What the words say is written: the file itself, or files with that stem.
  static void expect_written(const fs::path& folder, const std::string& words) {
    const std::vector<std::string> parts = split(words, ' ');
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      if (parts[i] != "--out" && parts[i] != "--json" && parts[i] != "--page" && parts[i] != ">")
        continue;
      bool found = fs::exists(folder / parts[i + 1]);
      for (const char* ending : {".npz", "-1.npz"})
        found = found || fs::exists(folder / (parts[i + 1] + ending));
      EXPECT_TRUE(found) << words << " did not write " << parts[i + 1];
    }
  }

  static std::unique_ptr<TemporaryFolder> base_;
};

std::unique_ptr<TemporaryFolder> Examples::base_;

TEST_F(Examples, OfEveryCommandRunAsWritten) {
  const Json declared = parse_json(run_mocaplm("declarations").text, "declarations");
  int ran_examples = 0;
  for (const Json& command : declared)
    for (const Json& example : command["examples"]) {
      const std::string words = example["words"];
      // Films are ffmpeg's; without it render says so.
      if (contains(words, ".gif") && find_program("ffmpeg").empty()) continue;
      TemporaryFolder own;
      fs::copy(base_->path(), own.path(), fs::copy_options::recursive);
      // What it makes is not there before.
      const std::vector<std::string> parts = split(words, ' ');
      for (std::size_t i = 0; i + 1 < parts.size(); ++i)
        if (parts[i] == "--out") fs::remove_all(own / parts[i + 1]);
      const Ran ran = run_in(own.path(), words);
      EXPECT_EQ(ran.code, 0) << "mocaplm " << words << "\n" << ran.text;
      expect_written(own.path(), words);
      ++ran_examples;
    }
  EXPECT_GE(ran_examples, 2 * 17);
}

}  // namespace
}  // namespace mocaplm::examples_slow_test
