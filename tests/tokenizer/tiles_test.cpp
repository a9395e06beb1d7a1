#include "tokenizer/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/angles.h"
#include "common/settings.h"
#include "motion/rotation.h"
#include "support/refusal.h"
#include "tests/tokenizer/random_clips.h"
#include "tokenizer/word_measure.h"

namespace mocaplm::tiles_test {
namespace {

std::vector<Clip> some_clips() {
  std::vector<Clip> clips;
  for (std::uint64_t seed = 40; seed < 46; ++seed)
    clips.push_back(random_clip(seed, 100 + 31 * static_cast<Eigen::Index>(seed - 40)));
  return clips;
}

TokenizerConfig frames(const std::string& root = "absolute", const std::string& binning = "uniform",
                       std::int64_t bins = 360) {
  TokenizerConfig config;
  config.root = root;
  config.binning = binning;
  config.bins = bins;
  return config;
}

TileConfig tiles(std::int64_t length, double keep = 0.1) {
  TileConfig config;
  config.tiles = length;
  config.keep = keep;
  return config;
}

TileTokenizer fit(const TokenizerConfig& frames, const TileConfig& tiles,
                  const std::vector<Clip>& clips) {
  return TileTokenizer::fit(frames, tiles, clips.size(), [&](std::size_t i) { return clips[i]; });
}

// The thesis's algorithm, plainly: sums of cosines, sorting, nearest bin.
Eigen::MatrixXd slow_decode(const Eigen::MatrixXd& values, Eigen::Index n, double keep,
                            double step) {
  Eigen::MatrixXd padded((values.rows() + n - 1) / n * n, values.cols());
  for (Eigen::Index t = 0; t < padded.rows(); ++t)
    padded.row(t) = values.row(std::min(t, values.rows() - 1));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(padded.rows(), padded.cols());
  for (Eigen::Index first = 0; first < padded.rows(); first += n) {
    Eigen::MatrixXd y(n, values.cols());
    std::vector<double> sizes;
    const auto cosine = [&](Eigen::Index k, Eigen::Index t) {
      return std::sqrt((k == 0 ? 1.0 : 2.0) / double(n)) *
             std::cos(kPi * (double(t) + 0.5) * double(k) / double(n));
    };
    for (Eigen::Index c = 0; c < y.cols(); ++c)
      for (Eigen::Index k = 0; k < n; ++k) {
        y(k, c) = 0;
        for (Eigen::Index t = 0; t < n; ++t) y(k, c) += cosine(k, t) * padded(first + t, c);
        sizes.push_back(std::abs(y(k, c)));
      }
    std::sort(sizes.rbegin(), sizes.rend());
    const double least = sizes[static_cast<std::size_t>(std::llround(keep * double(y.size()))) - 1];
    for (Eigen::Index c = 0; c < y.cols(); ++c)
      for (Eigen::Index k = 0; k < n; ++k)
        if (std::abs(y(k, c)) >= least)
          for (Eigen::Index t = 0; t < n; ++t)
            out(first + t, c) += cosine(k, t) * step * std::round(y(k, c) / step);
  }
  return out;
}

TEST(TileTokenizer, DoesWhatTheThesisSays) {
  const std::vector<Clip> clips = some_clips();
  for (const Eigen::Index n : {15, 30}) {
    const TileTokenizer tokenizer = fit(frames("none"), tiles(n, 0.2), clips);
    // The width of the bins, from the file; the mean is taken off first.
    const Json json = tokenizer.to_json();
    const auto centres = json["bins"][0]["centres"].get<std::vector<double>>();
    const auto mean = json["components"]["mean"].get<std::vector<double>>();
    const double step = centres[181] - centres[180];
    Eigen::MatrixXd values = tokenizer.channel_values(clips[1]);
    const Eigen::RowVectorXd middle = Eigen::Map<const Eigen::RowVectorXd>(mean.data(), 39);
    const Eigen::MatrixXd expected =
        slow_decode(values.rowwise() - middle, n, 0.2, step).rowwise() + middle;
    const Eigen::MatrixXd found = tokenizer.decode_values(tokenizer.encode(clips[1]).ids, "test");
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(TileTokenizer, WithEverythingKeptTheErrorIsThatOfTheBins) {
  const std::vector<Clip> clips = some_clips();
  for (const bool lapped : {false, true})
    for (const std::string scan : {"frequency", "component"})
      for (const int pca : {0, 42}) {
        TileConfig config = tiles(20, 1);
        config.lapped = lapped;
        config.scan = scan;
        config.pca = pca;
        const TileTokenizer tokenizer = fit(frames("absolute", "uniform", 3000), config, clips);
        const auto centres = tokenizer.to_json()["bins"][0]["centres"].get<std::vector<double>>();
        const double half = 0.5 * (centres[1] - centres[0]);
        for (const Clip& clip : clips) {
          const Eigen::MatrixXd values = tokenizer.channel_values(clip);
          const Eigen::MatrixXd back =
              tokenizer.decode_values(tokenizer.encode(clip).ids, "test").topRows(values.rows());
          // Orthonormal all the way: no more than half a bin a coefficient, as a mean square.
          const double rms = (back - values).norm() / std::sqrt(double(values.size()));
          EXPECT_LT(rms, half);
          const Clip decoded = tokenizer.decode(tokenizer.encode(clip).ids, clip.frames(), "x",
                                                clip.trans.row(0).transpose());
          EXPECT_EQ(decoded.frames(), clip.frames());
          EXPECT_LT((decoded.trans - clip.trans).norm() / std::sqrt(double(clip.frames())),
                    10 * half);
        }
      }
}

TEST(TileTokenizer, WordsSayTheSameInEveryForm) {
  const std::vector<Clip> clips = some_clips();
  for (const std::string binning : {"uniform", "quantile", "pooled_quantile"})
    for (const std::int64_t runs : {1, 7, 256}) {
      TileConfig config = tiles(15, 0.07);
      config.runs = runs;
      config.pca = 20;
      const TileTokenizer tokenizer = fit(frames("none", binning, 60), config, clips);
      const TokenStream stream = tokenizer.encode(clips[2]);
      const auto words = std::count(stream.ids.begin(), stream.ids.end(), 3);
      EXPECT_EQ(words, (clips[2].frames() + 14) / 15);
      EXPECT_EQ(tokenizer.from_text(tokenizer.to_text(stream.ids)), stream.ids);
      EXPECT_EQ(tokenizer.check_words(stream.ids, "x"), static_cast<std::size_t>(words));
      for (const std::int32_t id : stream.ids) ASSERT_LT(id, tokenizer.vocabulary());
      // Places ascend in a word and are below its separator's.
      for (std::size_t i = 1; i < stream.size(); ++i) {
        if (stream.frame[i] != stream.frame[i - 1]) continue;
        ASSERT_GT(stream.channel[i], stream.channel[i - 1]);
      }
    }
}

TEST(TileTokenizer, KeepsTheShareAndTheThreshold) {
  const std::vector<Clip> clips = some_clips();
  const auto length = [&](double keep, double threshold) {
    TileConfig config = tiles(30, keep);
    config.threshold = threshold;
    config.runs = 2000;
    const TileTokenizer tokenizer = fit(frames("none", "quantile", 200), config, clips);
    std::int64_t values = 0;
    const TokenStream stream = tokenizer.encode(clips[0]);
    for (const std::int32_t id : stream.ids) values += id >= 4 && id < 204;
    return double(values) / double(std::count(stream.ids.begin(), stream.ids.end(), 3));
  };
  EXPECT_NEAR(length(0.1, 0), 117, 3) << "of 30 * 39 coefficients, but for bins next to zero";
  EXPECT_NEAR(length(0.3, 0), 351, 10);
  EXPECT_LT(length(0.3, 0.3), 0.5 * length(0.3, 0));
}

TEST(TileTokenizer, LappedTilesHideTheirBorders) {
  const std::vector<Clip> clips = some_clips();
  double seam[2];
  for (const bool lapped : {false, true}) {
    TileConfig config = tiles(30, 0.06);
    config.lapped = lapped;
    const TileWords tokenizer(fit(frames("none"), config, clips));
    WordMeasure measure = start_measure(tokenizer);
    for (const Clip& clip : clips) measure_clip(tokenizer, clip, measure);
    seam[lapped] = measure.seam();
  }
  EXPECT_GT(seam[0], 1.8);
  EXPECT_LT(seam[1], 1.25);
}

TEST(TileTokenizer, IndependentAndPrincipalComponentsLoseTheSame) {
  const std::vector<Clip> clips = some_clips();
  double error[2];
  for (const bool ica : {false, true}) {
    TileConfig config = tiles(20, 1);
    (ica ? config.ica : config.pca) = 15;
    const TileTokenizer tokenizer = fit(frames("none", "uniform", 3500), config, clips);
    const Eigen::MatrixXd values = tokenizer.channel_values(clips[0]);
    error[ica] =
        (tokenizer.decode_values(tokenizer.encode(clips[0]).ids, "x").topRows(values.rows()) -
         values)
            .norm();
  }
  EXPECT_NEAR(error[1] / error[0], 1, 0.02) << "they span the same space";
}

TEST(TileTokenizer, JsonGoesThereAndBackExactly) {
  const std::vector<Clip> clips = some_clips();
  std::set<std::string> prints;
  for (const std::string kind : {"none", "pca", "ica"}) {
    TileConfig config = tiles(15);
    config.lapped = kind == "pca";
    if (kind == "pca") config.pca = 10;
    if (kind == "ica") config.ica = 10;
    const TileTokenizer tokenizer = fit(frames("absolute", "quantile", 50), config, clips);
    const TileTokenizer back =
        TileTokenizer::from_json(parse_json(tokenizer.to_json().dump(), "t"), "t");
    EXPECT_EQ(back.fingerprint(), tokenizer.fingerprint());
    EXPECT_EQ(back.to_json().dump(), tokenizer.to_json().dump());
    EXPECT_EQ(back.encode(clips[1]).ids, tokenizer.encode(clips[1]).ids);
    EXPECT_EQ(tokenizer.fingerprint(),
              fit(frames("absolute", "quantile", 50), config, clips).fingerprint())
        << "the same again";
    prints.insert(back.fingerprint());
  }
  EXPECT_EQ(prints.size(), 3u);
}

TEST(TileTokenizer, RefusesFilesThatAreNotWhole) {
  TileConfig config = tiles(15);
  config.pca = 5;
  const Json good = fit(frames("none", "uniform", 50), config, some_clips()).to_json();
  for (const auto& item : good.items()) {
    Json bad = good;
    bad.erase(item.key());
    EXPECT_PRED2(contains, refusal([&] { TileTokenizer::from_json(bad, "t.json"); }),
                 "\"" + item.key() + "\": missing");
  }
  const auto says = [&](const std::string& part, const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    EXPECT_PRED2(contains, refusal([&] { TileTokenizer::from_json(bad, "t.json"); }), part);
  };
  says("unknown key", [](Json& j) { j["extra"] = 1; });
  says("unknown key", [](Json& j) { j["tiles"]["extra"] = 1; });
  says("\"keep\": missing", [](Json& j) { j["tiles"].erase("keep"); });
  says("\"fps\": missing", [](Json& j) { j["settings"].erase("fps"); });
  says("changed by hand", [](Json& j) { j["tiles"]["keep"] = 0.2; });
  says("changed by hand", [](Json& j) { j["components"]["analysis"][3] = 0.5; });
  says("expected 39 rows of 5", [](Json& j) { j["components"]["analysis"].push_back(0.5); });
  says("not both", [](Json& j) { j["tiles"]["ica"] = 5; });
  says("list of 1 sets", [](Json& j) { j["bins"] = Json::array(); });
  says("at least one frame", [](Json& j) { j["tiles"]["tiles"] = 0; });
}

TEST(TileTokenizer, RefusesStreamsThatAreNotWords) {
  TileConfig config = tiles(15, 0.1);
  config.pca = 2;
  const TileTokenizer tokenizer = fit(frames("none", "uniform", 50), config, some_clips());
  const auto refused = [&](const std::vector<std::int32_t>& ids) {
    return refusal([&] { tokenizer.decode(ids, 0, "s"); });
  };
  EXPECT_PRED2(contains, refused({}), "no tokens");
  EXPECT_PRED2(contains, refused({4, 3, 3}), "s: word 2, character 1: found a separator");
  EXPECT_PRED2(contains, refused({4, 3, 5}), "s: word 2, character 2: found the end");
  EXPECT_PRED2(contains, refused({4, 0, 3}), "s: word 1, character 2: found token 0");
  EXPECT_PRED2(contains, refused({4, tokenizer.vocabulary(), 3}), "found token");
  EXPECT_PRED2(contains, refused(std::vector<std::int32_t>(31, 4)), "more than the 30");
  EXPECT_PRED2(contains, refused({4, 54 + 29, 3}), "more than the 30");
  EXPECT_EQ(tokenizer.decode({4, 54 + 28, 3}).frames(), 15);
  EXPECT_PRED2(contains, refusal([&] { tokenizer.from_text("!! \n"); }), "character 4");
}

TEST(TileTokenizer, RefusesSettingsThatCannotBe) {
  const std::vector<Clip> clips = some_clips();
  const auto refused = [&](const TokenizerConfig& frames, const TileConfig& tiles) {
    return refusal<UsageError>([&] { fit(frames, tiles, clips); });
  };
  TileConfig config = tiles(15);
  EXPECT_PRED2(contains, refused(frames("steps"), config), "absolute or none");
  EXPECT_PRED2(contains, refused(frames("none", "uniform", 4000), config), "characters");
  config.pca = 50;
  EXPECT_PRED2(contains, refused(frames("none"), config), "of only 39 channels");
  config.pca = config.ica = 5;
  EXPECT_PRED2(contains, refused(frames("none"), config), "not both");
  EXPECT_PRED2(contains, refused(frames("none"), tiles(0)), "at least one frame");
  EXPECT_THROW(fit(frames("none"), tiles(15), {}), UsageError);
}

// A dancer who never moves: every word is one run, and comes back.
TEST(TileTokenizer, AStillClipIsToldByShortWords) {
  Clip still = random_clip(1, 50);
  for (Eigen::Index t = 1; t < 50; ++t) {
    still.poses.row(t) = still.poses.row(0);
    still.trans.row(t) = still.trans.row(0);
  }
  for (const std::string binning : {"uniform", "quantile"}) {
    const TileTokenizer tokenizer = fit(frames("none", binning), tiles(20), {still});
    const TokenStream stream = tokenizer.encode(still);
    EXPECT_EQ(stream.size(), 6u) << "three words of one character";
    const Clip back = tokenizer.decode(stream.ids, 50);
    EXPECT_LT((back.poses - still.poses).middleCols<3>(0).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace mocaplm::tiles_test
