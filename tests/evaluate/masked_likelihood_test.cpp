// Bits of hidden tokens against the definition computed one token at a time.
#include "evaluate/masked_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "model/masked_input.h"
#include "support/random_model.h"
#include "support/small_models.h"

namespace mocaplm::masked_likelihood_test {
namespace {

constexpr std::size_t kPerFrame = 4, kRoom = 5;

TEST(ScoreMaskedClips, EveryTokenIsHiddenOnceWithASeventhOfTheOthers) {
  const StreamShape shape = {20, 4, 11, 3};
  const std::vector<int> passes = masking_passes(shape, 400, 5);
  std::map<int, int> counts;
  for (std::size_t i = 0; i < 400; ++i) {
    if (i % 4 == 3) {
      EXPECT_EQ(passes[i], -1);
    }
    ++counts[passes[i]];
  }
  for (int pass = 0; pass < kMaskingPasses; ++pass) EXPECT_NEAR(counts[pass], 300 / 7, 1) << pass;
  EXPECT_EQ(counts.size(), 8u);
  EXPECT_NE(masking_passes(shape, 400, 6), passes);
}

TEST(ScoreMaskedClips, EqualsOneTokenAtATime) {
  for (ModelDescription d : all_variants()) {
    d.config.objective = "masked";
    const auto model = random_model(d, 11);
    Random random(4);
    std::vector<ScoredClip> clips;
    for (const std::int64_t frames : {1, 5, 6, 13}) {
      ScoredClip clip;
      clip.ids = random_stream(d.shape, frames, random);
      clip.prefix = {2};
      clips.push_back(clip);
    }
    const std::vector<BitCount> counts = score_masked_clips(*model, clips, 3);
    const at::NoGradGuard no_grad;
    for (std::size_t c = 0; c < clips.size(); ++c) {
      const std::size_t frames = clips[c].ids.size() / kPerFrame;
      const std::vector<int> passes = masking_passes(d.shape, clips[c].ids.size(), c);
      std::vector<double> bits(kPerFrame, 0.0);
      for (std::size_t i = 0; i < clips[c].ids.size(); ++i) {
        if (i % kPerFrame == 3) continue;
        for (const CentralWindow& w : central_windows(frames, kRoom)) {
          const std::size_t frame = i / kPerFrame;
          if (frame < w.from || frame >= w.to) continue;
          std::vector<std::int32_t> shown;
          for (std::size_t k = kPerFrame * w.first; k < kPerFrame * w.last; ++k)
            shown.push_back(passes[k] == passes[i] ? 1 : clips[c].ids[k]);
          ModelInput input = masked_input(d, {2}, shown);
          while (input.size() < 24) append_prefix(input, d, 0, false, shown, 0);
          const Batch batch = stack({input});
          const at::Tensor logs =
              at::log_softmax(model->logits(model->hidden(batch), batch)[0].to(at::kDouble), -1);
          const auto position = static_cast<std::int64_t>(1 + i - kPerFrame * w.first);
          bits[i % kPerFrame] -= logs[position][clips[c].ids[i]].item<double>() / std::log(2.0);
        }
      }
      EXPECT_EQ(counts[c].frames, static_cast<std::int64_t>(frames));
      for (std::size_t k = 0; k < kPerFrame; ++k)
        EXPECT_NEAR(counts[c].bits[k], bits[k], 1e-3 + 1e-4 * bits[k])
            << variant_name(d) << ", clip " << c << ", channel " << k;
    }
  }
}

}  // namespace
}  // namespace mocaplm::masked_likelihood_test
