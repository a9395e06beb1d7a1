// Bits of every frame against the definition computed one window at a time.
#include "evaluate/likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_model.h"
#include "support/small_models.h"

namespace mocaplm::likelihood_test {
namespace {

constexpr std::size_t kPerFrame = 4, kRoom = 5;  // (24 - 1 .. 4 prefix tokens) / 4 tokens a frame

// Clips shorter than, as long as, and longer than a window, with prefixes of one to four tokens.
std::vector<ScoredClip> some_clips(const ModelDescription& d) {
  Random random(4);
  std::vector<ScoredClip> clips;
  for (const std::int64_t frames : {1, 2, 4, 5, 6, 7, 12, 23}) {
    ScoredClip clip;
    clip.ids = random_stream(d.shape, frames, random);
    clip.prefix = {2};
    while (clip.prefix.size() < 1 + static_cast<std::size_t>(frames) % 4) clip.prefix.push_back(15);
    clips.push_back(clip);
  }
  return clips;
}

// Windows start every half window; the first shows the clip's beginning, each later one scores the
// frames that no earlier one reached. Returns bits per frame and channel.
std::vector<std::vector<double>> plain(LanguageModel& model, const ScoredClip& clip) {
  const at::NoGradGuard no_grad;
  const std::size_t frames = clip.ids.size() / kPerFrame;
  std::vector<std::vector<double>> bits(frames);
  for (std::size_t t = 0; t < frames; ++t) {
    std::size_t first = 0;
    while (t >= first + kRoom) first += kRoom / 2;
    const ModelInput input = window_input(model.description(), clip.prefix, clip.ids,
                                          first * kPerFrame, (t + 1 - first) * kPerFrame);
    const Batch batch = stack({input});
    const at::Tensor logs =
        at::log_softmax(model.logits(model.hidden(batch), batch)[0].to(at::kDouble), -1);
    for (std::size_t c = 0; c < kPerFrame; ++c) {
      const std::size_t position = clip.prefix.size() - 1 + (t - first) * kPerFrame + c;
      const std::int32_t id = clip.ids[t * kPerFrame + c];
      bits[t].push_back(-logs[static_cast<std::int64_t>(position)][id].item<double>() /
                        std::log(2.0));
    }
  }
  return bits;
}

TEST(ScoreClips, EqualsOneFrameAtATime) {
  for (const ModelDescription& d : all_variants()) {
    const auto model = random_model(d, 11);
    const std::vector<ScoredClip> clips = some_clips(d);
    const std::vector<BitCount> counts = score_clips(*model, clips, 3);
    ASSERT_EQ(counts.size(), clips.size());
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const auto expected = plain(*model, clips[i]);
      EXPECT_EQ(counts[i].frames, static_cast<std::int64_t>(expected.size()));
      ASSERT_EQ(counts[i].bits.size(), kPerFrame);
      for (std::size_t c = 0; c < kPerFrame; ++c) {
        double sum = 0;
        for (const auto& frame : expected) sum += frame[c];
        EXPECT_NEAR(counts[i].bits[c], sum, 1e-3 + 1e-4 * sum)
            << variant_name(d) << ", clip " << i << ", channel " << c;
      }
    }
  }
}

TEST(ScoreClips, TheEngineGivesTheSameBits) {
  for (const ModelDescription& d : all_variants()) {
    const auto model = random_model(d, 11);
    StoredModel stored;
    stored.description = d;
    stored.tensors = random_weights(d, 11);
    const std::vector<ScoredClip> clips = some_clips(d);
    const std::vector<BitCount> expected = score_clips(*model, clips, 4);
    const auto decoder = make_decoder(stored, "made up", {Precision::f32, 2, 3});
    const std::vector<BitCount> counts = score_clips(*decoder, clips);
    ASSERT_EQ(counts.size(), clips.size());
    for (std::size_t i = 0; i < clips.size(); ++i)
      for (std::size_t c = 0; c + 1 < kPerFrame; ++c)
        EXPECT_NEAR(counts[i].bits[c], expected[i].bits[c], 1e-3 + 1e-4 * expected[i].bits[c])
            << variant_name(d) << ", clip " << i << ", channel " << c;
  }
}

TEST(ScoreClips, BatchingAndPaddingChangeNothing) {
  const ModelDescription d = small_description();
  const auto model = random_model(d, 11);
  const std::vector<ScoredClip> clips = some_clips(d);
  const std::vector<BitCount> one = score_clips(*model, clips, 1);
  for (const std::int64_t at_once : {2, 5, 64}) {
    std::size_t done = 0, all = 0;
    const std::vector<BitCount> many =
        score_clips(*model, clips, at_once, [&](std::size_t n, std::size_t total) {
          EXPECT_GT(n, done);
          done = n, all = total;
        });
    EXPECT_EQ(done, all);
    for (std::size_t i = 0; i < clips.size(); ++i)
      for (std::size_t c = 0; c < kPerFrame; ++c)
        EXPECT_NEAR(one[i].bits[c], many[i].bits[c], 1e-3) << at_once << " " << i << " " << c;
  }
  EXPECT_TRUE(score_clips(*model, {}, 4).empty());
}

TEST(ScoreClips, AModelOfZerosKnowsNothing) {
  for (const ModelDescription& d : all_variants()) {
    auto model = make_language_model(d);
    const at::NoGradGuard no_grad;
    for (at::Tensor p : model->parameters()) p.zero_();
    const std::vector<ScoredClip> clips = some_clips(d);
    const std::vector<BitCount> counts = score_clips(*model, clips, 4);
    for (std::size_t i = 0; i < clips.size(); ++i)
      for (const double bits : counts[i].bits)
        EXPECT_NEAR(bits / static_cast<double>(counts[i].frames),
                    std::log2(static_cast<double>(d.shape.vocabulary)), 1e-4)
            << variant_name(d);
  }
}

}  // namespace
}  // namespace mocaplm::likelihood_test
