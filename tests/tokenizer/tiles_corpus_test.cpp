// The tile tokenizer through files: what `mocaplm tokenize --tiles` writes and reads.
#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/formats/formats.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "tokenizer/corpus.h"
#include "tokenizer/tokenize.h"

namespace mocaplm::tiles_corpus_test {
namespace {

namespace fs = std::filesystem;

class TilesCorpus : public testing::Test {
 protected:
  void SetUp() override {
    write_dataset(
        folder_ / "data",
        {{"a", "train", 121, {{"style", "s"}}, 60}, {"b", "train", 60}, {"c", "test", 7}});
    options_.inputs = {(folder_ / "data").string()};
    options_.config.root = "absolute";
    options_.tiles.tiles = 15;
    options_.tiles.keep = 0.3;
    options_.tiles.pca = 42;
    options_.tiles.lapped = true;
    options_.out = folder_ / "out";
    options_.text = true;
  }

  TemporaryFolder folder_;
  TokenizeOptions options_;
};

TEST_F(TilesCorpus, ComesBackAsClipsOfTheSameLength) {
  const Table table = tokenize(options_);
  EXPECT_EQ(table.rows()[0][1], 3);
  const fs::path corpus = options_.out / "corpus.txt", file = options_.out / "tokenizer.json";
  const auto tokenizer = load_tokenizer(file);
  const std::vector<CorpusClip> lines = read_corpus(corpus, *tokenizer);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].frames, 41) << "at 20 frames a second";
  EXPECT_EQ(lines[0].labels.at("style"), "s");
  EXPECT_EQ(lines[2].frames, 7) << "less than one tile";

  const Table back = untokenize(corpus, file, folder_ / "back");
  EXPECT_EQ(back.rows()[0][1], 41);
  const Clip clip = read_clip(folder_ / "back" / "c.npz");
  EXPECT_EQ(clip.frames(), 7);
  const Clip source = read_clip(folder_ / "data" / "clips" / "c.npz");
  EXPECT_LT((clip.trans - source.trans).norm(), 0.3);

  // A text alone has no lengths: all of the last tile.
  fs::remove(corpus_index_path(corpus));
  EXPECT_EQ(untokenize(corpus, file, folder_ / "alone").rows()[2][1], 15);
}

TEST_F(TilesCorpus, RefusesAnotherTokenizersStream) {
  tokenize(options_);
  TokenizeOptions other = options_;
  other.out = folder_ / "frames";
  other.tiles = {};
  tokenize(other);
  const auto refused = [&](const fs::path& corpus, const fs::path& file) {
    return refusal([&] { untokenize(corpus, file, folder_ / "none"); });
  };
  // The frames' text is no text of tiles, and the tiles' none of frames; where the characters
  // would do, the fingerprint does not.
  refused(options_.out / "corpus.txt", other.out / "tokenizer.json");
  refused(other.out / "corpus.txt", options_.out / "tokenizer.json");
  TokenizeOptions similar = options_;
  similar.out = folder_ / "similar";
  similar.tiles.keep = 0.29;
  tokenize(similar);
  EXPECT_PRED2(contains, refused(options_.out / "corpus.txt", similar.out / "tokenizer.json"),
               "the corpus was written by tokenizer");
  other.out = options_.out;
  EXPECT_PRED2(contains, refusal([&] { tokenize(other); }), "is another tokenizer");
}

TEST_F(TilesCorpus, LengthsInTheIndexMustFitTheWords) {
  tokenize(options_);
  const fs::path index = options_.out / "corpus.clips.json";
  Json json = load_json(index);
  for (const int frames : {30, 46}) {
    json["clips"][0]["frames"] = frames;
    save_json(index, json);
    EXPECT_PRED2(contains, refusal([&] {
                   read_corpus(options_.out / "corpus.txt",
                               *load_tokenizer(options_.out / "tokenizer.json"));
                 }),
                 "\"frames\": expected 31 to 45");
  }
}

TEST_F(TilesCorpus, PiecesLieBeside) {
  options_.pieces.bpe = 700;
  const Table table = tokenize(options_);
  const Pieces pieces = Pieces::load(options_.out / "pieces.model");
  EXPECT_LE(pieces.size(), 700);
  const auto tokenizer = load_tokenizer(options_.out / "tokenizer.json");
  for (const CorpusClip& line : read_corpus(options_.out / "corpus.txt", *tokenizer)) {
    const std::string text = tokenizer->to_text(line.ids);
    EXPECT_EQ(pieces.decode(pieces.encode(text)), text);
  }
}

}  // namespace
}  // namespace mocaplm::tiles_corpus_test
