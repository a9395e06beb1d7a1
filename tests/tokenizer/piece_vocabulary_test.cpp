// The pieces that models speak, read and encoded without SentencePiece's library, against that
// library.
#include "tokenizer/piece_vocabulary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "motion/formats/formats.h"
#include "support/refusal.h"
#include "tokenizer/any_tokenizer.h"
#include "tokenizer/pieces.h"
#include "tokenizer/random_clips.h"
#include "tokenizer/report.h"

namespace mocaplm::piece_vocabulary_test {
namespace {

std::vector<Clip> some_clips() {
  std::vector<Clip> clips;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) clips.push_back(random_clip(seed, 120));
  return clips;
}

Tokenizer fitted(const std::string& root = "steps", int bins = 24) {
  TokenizerConfig config;
  config.bins = bins;
  config.joints = {"pelvis", "left_knee", "right_elbow"};
  config.root = root;
  return Tokenizer::fit(config, some_clips());
}

Pieces learnt(const Tokenizer& tokenizer, bool unigram, std::int64_t size = 200) {
  PieceConfig config;
  (unigram ? config.unigram : config.bpe) = size;
  const std::vector<Clip> clips = some_clips();
  return learn_pieces(config, FrameWords(tokenizer), clips.size(),
                      [&](std::size_t i) { return clips[i]; });
}

std::string text_of(const PieceVocabulary& pieces, const Tokenizer& tokenizer, std::int32_t token) {
  const PieceVocabulary::Characters all = pieces.characters(token);
  return tokenizer.to_text({all.data, all.data + all.size});
}

TEST(PieceVocabulary, CutsFramesAsSentencePieceDoes) {
  for (const bool unigram : {false, true})
    for (const char* root : {"steps", "none"}) {
      const Tokenizer tokenizer = fitted(root);
      const Pieces library = learnt(tokenizer, unigram);
      const PieceVocabulary own(library.bytes(), tokenizer, "pieces");
      EXPECT_EQ(own.bpe(), !unigram);
      EXPECT_EQ(own.learnt(), library.size());
      EXPECT_GT(own.count(), 50);
      EXPECT_GT(own.longest(), 2);
      std::size_t longer = 0;
      for (std::uint64_t seed = 1; seed < 12; ++seed) {  // half of them not learnt from
        const std::vector<std::int32_t> ids = tokenizer.encode(random_clip(seed, 90)).ids;
        std::vector<std::string> wanted, found;
        for (const std::int32_t piece : library.encode(tokenizer.to_text(ids)))
          wanted.push_back(library.text(piece));
        const PieceStream stream = own.encode(ids);
        for (const std::int32_t token : stream.tokens)
          found.push_back(text_of(own, tokenizer, token));
        ASSERT_EQ(found, wanted);
        longer += ids.size() > stream.tokens.size();
      }
      EXPECT_EQ(longer, 11u);
    }
}

// Recordings, where they are there: learnt on one half of each, cut and put together on all.
TEST(PieceVocabulary, CutsRecordingsAsSentencePieceDoes) {
  const std::filesystem::path folder =
      std::filesystem::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "data" / "formats";
  std::vector<Clip> clips, halves;
  if (std::filesystem::exists(folder))
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      const std::string ending = file.path().extension().string();
      if (ending != ".npz" && ending != ".pkl" && ending != ".bvh") continue;
      try {
        clips.push_back(read_clip(file.path().string(), {}));
      } catch (const DataError&) {  // a folder of odd files, too
        continue;
      }
      halves.push_back(
          slice(clips.back(), 0, std::max<Eigen::Index>(clips.back().frames() / 2, 1)));
    }
  if (clips.empty()) GTEST_SKIP() << "no recordings in " << folder;
  const Tokenizer tokenizer = Tokenizer::fit({}, clips);
  for (const bool unigram : {false, true}) {
    PieceConfig config;
    (unigram ? config.unigram : config.bpe) = 700;
    const Pieces library = learn_pieces(config, FrameWords(tokenizer), halves.size(),
                                        [&](std::size_t i) { return halves[i]; });
    const PieceVocabulary own(library.bytes(), tokenizer, "pieces");
    for (const Clip& clip : clips) {
      const std::vector<std::int32_t> ids = tokenizer.encode(clip).ids;
      std::vector<std::string> wanted, found;
      std::vector<std::int32_t> back;
      for (const std::int32_t piece : library.encode(tokenizer.to_text(ids)))
        wanted.push_back(library.text(piece));
      for (const std::int32_t token : own.encode(ids).tokens) {
        found.push_back(text_of(own, tokenizer, token));
        const PieceVocabulary::Characters all = own.characters(token);
        back.insert(back.end(), all.data, all.data + all.size);
      }
      EXPECT_EQ(found, wanted) << clip.name;
      EXPECT_EQ(back, ids) << clip.name;
    }
  }
}

TEST(PieceVocabulary, LosesNothingAndEndsWithFrames) {
  const Tokenizer tokenizer = fitted();
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  const PieceVocabulary pieces(learnt(tokenizer, false).bytes(), tokenizer, "pieces");
  const std::vector<std::int32_t> ids = tokenizer.encode(random_clip(77, 40)).ids;
  const PieceStream stream = pieces.encode(ids);
  ASSERT_EQ(stream.starts.size(), stream.tokens.size() + 1);
  ASSERT_EQ(stream.frame_count(), 40u);
  EXPECT_EQ(stream.frames.back(), stream.tokens.size());
  std::vector<std::int32_t> back;
  for (std::size_t i = 0; i < stream.tokens.size(); ++i) {
    EXPECT_EQ(stream.starts[i], back.size());
    EXPECT_TRUE(pieces.fits(stream.tokens[i], static_cast<int>(back.size() % per_frame)));
    const PieceVocabulary::Characters all = pieces.characters(stream.tokens[i]);
    back.insert(back.end(), all.data, all.data + all.size);
  }
  EXPECT_EQ(back, ids);
  for (std::size_t f = 0; f < 40; ++f) EXPECT_EQ(stream.starts[stream.frames[f]], f * per_frame);
  for (const std::size_t room : {0, 5, 30, 100, 10000}) {
    const std::size_t within = stream.frames_within(7, room);
    EXPECT_LE(stream.frames[7 + within] - stream.frames[7], room);
    if (7 + within < 40) {
      EXPECT_GT(stream.frames[8 + within] - stream.frames[7], room);
    }
  }
}

TEST(PieceVocabulary, EveryCharacterIsATokenAndLabelsMoveUp) {
  Tokenizer tokenizer = fitted();
  const PieceVocabulary pieces(learnt(tokenizer, true).bytes(), tokenizer, "pieces");
  const std::string before = pieces.fingerprint();
  tokenizer.add_label_values("style", {"calm", "wild"});
  EXPECT_EQ(PieceVocabulary(learnt(tokenizer, true).bytes(), tokenizer, "p").fingerprint(), before)
      << "label values change nothing";
  for (std::int32_t id = Tokenizer::kSeparator; id < Tokenizer::kFirstBin + tokenizer.bins();
       ++id) {
    EXPECT_EQ(pieces.id(id), id);
    ASSERT_EQ(pieces.characters(id).size, 1u);
    EXPECT_EQ(pieces.characters(id)[0], id);
  }
  EXPECT_EQ(pieces.end(), Tokenizer::kFirstBin + tokenizer.bins() + pieces.count());
  EXPECT_EQ(pieces.id(tokenizer.label_id("style", "calm")), pieces.end());
  EXPECT_EQ(pieces.ids({Tokenizer::kStart, tokenizer.label_id("style", "wild")}),
            (std::vector<std::int32_t>{Tokenizer::kStart, pieces.end() + 1}));
}

TEST(PieceVocabulary, FitsNeverReachBeyondAFrame) {
  const Tokenizer tokenizer = fitted();
  const int channels = tokenizer.channels();
  const PieceVocabulary pieces(learnt(tokenizer, false).bytes(), tokenizer, "pieces");
  for (std::int32_t token = Tokenizer::kSeparator; token < pieces.end(); ++token) {
    const PieceVocabulary::Characters all = pieces.characters(token);
    for (int channel = 0; channel <= channels; ++channel) {
      bool wanted = true;  // each character at a place of its kind
      for (std::size_t i = 0; i < all.size; ++i) {
        const int at = channel + static_cast<int>(i);
        wanted = wanted && at <= channels && (all[i] == Tokenizer::kSeparator) == (at == channels);
      }
      EXPECT_EQ(pieces.fits(token, channel), wanted) << token << " at " << channel;
    }
  }
}

TEST(PieceVocabulary, RefusesOtherPiecesAndDamagedFiles) {
  const Tokenizer tokenizer = fitted(), finer = fitted("steps", 30), coarse = fitted("steps", 12);
  const std::string bytes = learnt(tokenizer, false).bytes();
  const PieceVocabulary pieces(bytes, tokenizer, "pieces");
  const auto of_model = [&](const std::string& given, const Tokenizer& with) {
    return refusal([&] { PieceVocabulary::of_model(given, with, pieces.fingerprint(), "m"); });
  };
  EXPECT_EQ(PieceVocabulary::of_model(bytes, tokenizer, pieces.fingerprint(), "m").count(),
            pieces.count());
  EXPECT_FALSE(PieceVocabulary::of_model("", tokenizer, "", "m").any());
  EXPECT_PRED2(contains, of_model(bytes, finer), "is not what this model was trained with");
  EXPECT_PRED2(contains, of_model(learnt(tokenizer, true).bytes(), tokenizer), "fingerprint");
  EXPECT_PRED2(contains, of_model(bytes, coarse), "does not write");
  EXPECT_PRED2(contains, of_model("", tokenizer), "not a SentencePiece model");
  for (std::size_t cut = 0; cut < bytes.size(); cut += 7) {  // says so, or has fewer pieces
    try {
      const PieceVocabulary less(bytes.substr(0, cut), tokenizer, "cut");
      EXPECT_LE(less.count(), pieces.count());
    } catch (const DataError& error) {
      EXPECT_PRED2(contains, error.what(), "cut");
    }
  }
}

}  // namespace
}  // namespace mocaplm::piece_vocabulary_test
