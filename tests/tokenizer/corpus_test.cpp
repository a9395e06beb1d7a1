#include "tokenizer/corpus.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "tests/tokenizer/random_clips.h"

namespace mocaplm::corpus_test {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::Test {
 protected:
  void SetUp() override {
    file_ = folder_ / "corpus.txt";
    TokenizerConfig config;
    config.joints = {"pelvis", "left_knee"};
    std::vector<Clip> clips;
    for (std::uint64_t i = 0; i < 3; ++i)
      clips.push_back(random_clip(i, 10 + static_cast<Eigen::Index>(i)));
    tokenizer_ = Tokenizer::fit(config, clips);
    for (std::size_t i = 0; i < 3; ++i)
      clips_.push_back({"clip" + std::to_string(i),
                        {{"style", "s" + std::to_string(i)}},
                        clips[i].trans.row(0).transpose(),
                        tokenizer_.encode(clips[i]).ids});
  }

  std::string error_of_text(const std::string& text) {
    write_file(file_, text);
    return error_of_reading();
  }
  std::string error_of_reading() {
    try {
      read_corpus(file_, tokenizer_);
    } catch (const DataError& error) {
      return error.what();
    }
    return "(no error)";
  }
  void expect_error(const std::string& error, const std::string& part) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }

  TemporaryFolder folder_;
  fs::path file_;
  Tokenizer tokenizer_;
  std::vector<CorpusClip> clips_;
};

TEST_F(Corpus, ComesBackAsItWasWritten) {
  write_corpus(file_, tokenizer_, clips_);
  const std::string text = read_file(file_);
  const std::vector<CorpusClip> back = read_corpus(file_, tokenizer_);
  ASSERT_EQ(back.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back[i].name, clips_[i].name);
    EXPECT_EQ(back[i].labels, clips_[i].labels);
    EXPECT_EQ(back[i].start, clips_[i].start);
    EXPECT_EQ(back[i].ids, clips_[i].ids);
  }
  write_corpus(file_, tokenizer_, back);
  EXPECT_EQ(read_file(file_), text);
  EXPECT_EQ(text.find(" \n"), std::string::npos) << "no space at a line's end";
}

TEST_F(Corpus, TextAloneIsReadWithLineNames) {
  write_corpus(file_, tokenizer_, clips_);
  fs::remove(corpus_index_path(file_));
  const std::vector<CorpusClip> back = read_corpus(file_, tokenizer_);
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(back[1].name, "line_2");
  EXPECT_EQ(back[1].ids, clips_[1].ids);
}

TEST_F(Corpus, ErrorsNameLineAndPlace) {
  const std::string good = corpus_line(tokenizer_, clips_[0].ids);
  const std::size_t second_word = good.find(' ') + 1;
  expect_error(error_of_text(""), "is empty");
  expect_error(error_of_text(good + "\n\n" + good), "line 2: is empty");
  expect_error(
      error_of_text(good + "\n" + std::string(good).insert(second_word, "\xE4\xB8\x80") + "\n"),
      "line 2, character 11: found '\xE4\xB8\x80' (U+4E00)");
  expect_error(error_of_text(good + "\n" + std::string(good).insert(second_word, "!") + "\n"),
               "line 2: frame 1, separator: found bin ");
  expect_error(error_of_text(good + "\n" + good.substr(0, second_word) + "abc\n"),
               "line 2: frame 1, left_knee.x: found the separator, expected a bin");
  expect_error(error_of_text(good + "\r\n"), "U+000D");
}

TEST_F(Corpus, IndexMustFitTheTextAndTheTokenizer) {
  write_corpus(file_, tokenizer_, clips_);
  const Json good = load_json(corpus_index_path(file_));
  const auto changed = [&](const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    save_json(corpus_index_path(file_), bad);
    return error_of_reading();
  };
  expect_error(changed([](Json&) {}), "(no error)");
  expect_error(changed([](Json& j) { j["tokenizer"] = "0000"; }), "written by tokenizer 0000");
  expect_error(changed([](Json& j) { j["clips"].erase(2); }),
               "one entry for each of the corpus's 3 lines");
  expect_error(changed([](Json& j) { j["clips"][1]["name"] = "../x"; }), "plain file name");
  expect_error(changed([](Json& j) { j["clips"][1]["name"] = "clip0"; }), "there twice");
  expect_error(changed([](Json& j) { j["clips"][1]["frames"] = 5; }), "\"frames\"");
  expect_error(changed([](Json& j) { j["clips"][1]["start"] = {1, 2}; }), "three numbers");
  expect_error(changed([](Json& j) { j["clips"][1]["labels"] = {{"style", 3}}; }), "\"style\"");
  expect_error(changed([](Json& j) { j["clips"][1]["extra"] = 3; }), "unknown key");
}

}  // namespace
}  // namespace mocaplm::corpus_test
