#include "tokenizer/tokenize.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/formats/formats.h"
#include "motion/formats/npz.h"
#include "tests/tokenizer/random_clips.h"
#include "tokenizer/measure.h"

namespace mocaplm::tokenize_test {
namespace {

namespace fs = std::filesystem;

class Tokenize : public testing::Test {
 protected:
  void SetUp() override {
    for (std::uint64_t i = 0; i < 3; ++i) {
      const std::string name = "c" + std::to_string(i);
      write_npz(folder_ / (name + ".npz"), random_clip(i, 121, 60, name));
      options_.inputs.push_back((folder_ / (name + ".npz")).string());
    }
    options_.out = folder_ / "out";
    options_.text = true;
  }

  TemporaryFolder folder_;
  TokenizeOptions options_;
};

TEST_F(Tokenize, TextToClipsToTextIsTheIdentity) {
  for (const std::string root : {"steps", "absolute", "none"}) {
    options_.config.root = root;
    options_.out = folder_ / root;
    const Table table = tokenize(options_);
    EXPECT_EQ(table.rows()[0][1], 3);
    EXPECT_EQ(table.rows()[1][1], 3 * 41);
    untokenize(options_.out / "corpus.txt", options_.out / "tokenizer.json",
               folder_ / ("back_" + root));
    TokenizeOptions again;
    for (int i = 0; i < 3; ++i)
      again.inputs.push_back(
          (folder_ / ("back_" + root) / ("c" + std::to_string(i) + ".npz")).string());
    again.tokenizer = options_.out / "tokenizer.json";
    again.out = folder_ / ("again_" + root);
    again.text = true;
    tokenize(again);
    EXPECT_EQ(read_file(again.out / "corpus.txt"), read_file(options_.out / "corpus.txt"));
  }
}

TEST_F(Tokenize, NeverReplacesAnotherTokenizerOrForeignFiles) {
  tokenize(options_);
  const std::string before = read_file(options_.out / "tokenizer.json");
  tokenize(options_);  // the same again is fine
  options_.config.bins = 90;
  EXPECT_THROW(tokenize(options_), DataError);
  EXPECT_EQ(read_file(options_.out / "tokenizer.json"), before);

  options_.out = folder_ / "foreign";
  write_file(options_.out / "corpus.txt", "a novel");
  EXPECT_THROW(tokenize(options_), DataError);
  EXPECT_EQ(read_file(options_.out / "corpus.txt"), "a novel");
  EXPECT_FALSE(fs::exists(options_.out / "tokenizer.json"));

  options_.out = folder_ / "good";
  tokenize(options_);
  EXPECT_THROW(
      untokenize(options_.out / "corpus.txt", options_.out / "tokenizer.json", folder_.path()),
      DataError)
      << "the clips themselves lie there";
}

TEST_F(Tokenize, RefusesWhatCannotBe) {
  TokenizeOptions bad = options_;
  bad.inputs.push_back(bad.inputs[0]);
  EXPECT_THROW(tokenize(bad), UsageError);
  bad = options_;
  bad.inputs.clear();
  EXPECT_THROW(tokenize(bad), UsageError);
  bad = options_;
  bad.out = folder_ / "t.json";
  EXPECT_THROW(tokenize(bad), UsageError);
  bad.text = false;
  tokenize(bad);
  EXPECT_EQ(Tokenizer::load(bad.out).bins(), 360);
  bad.inputs = {folder_.path().string()};  // a folder, but no dataset
  EXPECT_THROW(tokenize(bad), DataError);
  bad.inputs = {(folder_ / "none.npz").string()};
  EXPECT_THROW(tokenize(bad), DataError);
}

// The errors to expect, mean and max: 1.03/2.00, 0.50/1.00, 0.25/0.50, 0.125/0.25 degrees for 90,
// 180, 360, 720 bins.
TEST(TokenizerLoss, OnRealMotionIsAsPublished) {
  const fs::path formats = fs::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "data" / "formats";
  if (!fs::exists(formats)) GTEST_SKIP() << formats << " is not here";
  for (const int bins : {90, 180, 360, 720}) {
    TokenizerConfig config;
    config.bins = bins;
    config.root = "none";
    const Tokenizer tokenizer = Tokenizer::fit(config, {});
    TokenizerLoss loss;
    for (const auto& file : fs::directory_iterator(formats))
      if (file.path().extension() == ".npz")
        encode_and_measure(tokenizer, read_clip(file.path()), loss);
    EXPECT_GT(loss.clips, 5);
    EXPECT_NEAR(loss.component_sum / static_cast<double>(loss.components), 90.0 / bins,
                0.06 * 90.0 / bins)
        << bins;
    EXPECT_NEAR(loss.component_max, 180.0 / bins, 0.02 * 180.0 / bins) << bins;
    EXPECT_LE(loss.component_max, 180.0 / bins);
    EXPECT_EQ(loss.encoded.clamped, 0);
  }
}

}  // namespace
}  // namespace mocaplm::tokenize_test
