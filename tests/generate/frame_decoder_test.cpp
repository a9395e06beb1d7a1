// The frame decoder against the trainable frame model, token by token, in every precision and with
// every set of instructions.
#include "generate/frame_decoder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.h"
#include "model/transformer/frame_transformer.h"
#include "model/transformer/weights.h"
#include "support/kernel_levels.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace mocaplm::frame_decoder_test {

namespace {

using Ids = std::vector<std::int32_t>;

constexpr std::size_t kPerFrame = 7;
constexpr std::size_t kBefore = 3;  // frames before the window

// Up to 78 frames: prompts take more than one run.
ModelDescription wider(ModelDescription d) {
  d.config.n_embd = 48;
  d.config.n_head = 3;
  d.config.block_size = 80;
  d.config.decoder_embd = 32;
  d.conditions = {"style"};
  return d;
}

StoredModel stored_model(const ModelDescription& d, std::uint64_t seed) {
  StoredModel stored;
  stored.description = d;
  stored.tensors = random_weights(d, seed);
  return stored;
}

Ids some_ids(const ModelDescription& d, std::uint64_t seed, std::int64_t frames = 75) {
  Random random(seed);
  return random_stream(d.shape, frames, random);
}

const Ids kPrefix = {2, 15};

// logits[token][id] of the trainable model for each token of the window behind `kBefore` frames.
std::vector<std::vector<float>> full_logits(const StoredModel& stored, const Ids& ids,
                                            const std::vector<std::int64_t>& order = {}) {
  const at::NoGradGuard no_grad;
  const auto model = std::dynamic_pointer_cast<FrameTransformer>(load_transformer(stored, "m"));
  if (!order.empty()) model->set_order(order);
  const std::size_t first = kBefore * kPerFrame;
  const ModelInput input =
      window_input(stored.description, kPrefix, ids, first, ids.size() - first);
  const Batch batch = stack({input});
  const at::Tensor logits = model->logits(model->hidden(batch), batch)[0].contiguous();
  std::vector<std::vector<float>> rows;
  for (std::int64_t t = static_cast<std::int64_t>(kPrefix.size()) - 1; t < logits.size(0); ++t) {
    const float* row = logits.data_ptr<float>() + t * logits.size(1);
    rows.emplace_back(row, row + logits.size(1));
  }
  return rows;
}

double worst(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(a[i]) - b[i]));
  return a.size() == b.size() ? most : 1e9;
}

Ids before(const Ids& ids) {
  return {ids.begin(), ids.begin() + kBefore * kPerFrame};
}

// Every token of the window; logits are asked for from `silent` on.
void expect_window(FrameDecoder& decoder, const Ids& ids,
                   const std::vector<std::vector<float>>& expected, std::size_t silent) {
  decoder.begin(0, kPrefix, before(ids));
  for (std::size_t t = 0; t + kBefore * kPerFrame < ids.size(); ++t) {
    if (t % kPerFrame + 1 < kPerFrame && t >= silent) {
      ASSERT_LT(worst(decoder.logits({0})[0], expected[t]), 1e-3) << "token " << t;
    }
    decoder.push(0, ids[kBefore * kPerFrame + t]);
  }
}

class EveryFrameDecoder : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Levels, EveryFrameDecoder, all_levels(), level_name);

TEST_P(EveryFrameDecoder, GivesTheTrainableModelsLogits) {
  ModelDescription forgetful = small_frames_description();
  forgetful.config.memory_layer = 0;
  for (const ModelDescription& variant :
       {small_frames_description(), small_frames_description("absolute"),
        small_frames_description("extrapolation", false), forgetful}) {
    const ModelDescription d = wider(variant);
    SCOPED_TRACE(variant_name(d));
    const StoredModel stored = stored_model(d, 1);
    const Ids ids = some_ids(d, 2);
    const auto expected = full_logits(stored, ids);
    FrameDecoder two(stored, "m", {Precision::f32, 2, 1}), one(stored, "m", {Precision::f32, 1, 1});
    expect_window(two, ids, expected, 64 * kPerFrame + 2);
    for (const std::size_t silent : {0, 1, 4, 9, 63 * 7, 64 * 7 + 2, 70 * 7 + 4})
      expect_window(one, ids, expected, silent);
    if (HasFatalFailure()) return;
  }
}

TEST(FrameDecoder, TakesTheJointsInAnyOrder) {
  const ModelDescription d = wider(small_frames_description());
  const StoredModel stored = stored_model(d, 3);
  const Ids ids = some_ids(d, 4, 12);
  const auto expected = full_logits(stored, ids, {1, 0});
  FrameDecoder decoder(stored, "m", {Precision::f32, 1, 1});
  decoder.begin(0, kPrefix, before(ids));
  decoder.set_order(0, {3, 4, 5, 0, 1, 2});
  for (std::size_t frame = 0; frame < 9; ++frame) {
    for (const std::size_t c : {3, 4, 5, 0, 1, 2}) {
      const std::size_t t = frame * kPerFrame + c;
      EXPECT_LT(worst(decoder.logits({0})[0], expected[t]), 1e-3) << frame << " " << c;
      decoder.push(0, ids[kBefore * kPerFrame + t]);
    }
    decoder.push(0, 3);
  }
}

TEST(FrameDecoder, PastTheContextItGoesOnAsIfItHadBegunWithTheNewerHalf) {
  ModelDescription d = wider(small_frames_description());
  d.config.block_size = 12;  // 10 frames
  const StoredModel stored = stored_model(d, 5);
  const Ids ids = some_ids(d, 6, 30);
  FrameDecoder sliding(stored, "m", {Precision::f32, 1, 1}), fresh(stored, "m");
  sliding.begin(0, kPrefix, {});
  std::size_t first = 0, slides = 0;  // of the window
  for (std::size_t t = 0; t < ids.size(); ++t) {
    const std::size_t frame = t / kPerFrame;
    if (frame - first > 10) first = frame - 5, ++slides;
    if (t % kPerFrame + 1 < kPerFrame) {
      const auto at = [&](std::size_t i) { return ids.begin() + static_cast<std::ptrdiff_t>(i); };
      fresh.begin(0, kPrefix, {at(0), at(first * kPerFrame)});
      for (std::size_t i = first * kPerFrame; i < t; ++i) fresh.push(0, ids[i]);
      EXPECT_LT(worst(sliding.logits({0})[0], fresh.logits({0})[0]), 1e-4) << "token " << t;
    }
    sliding.push(0, ids[t]);
  }
  EXPECT_EQ(slides, 4u);
}

TEST_P(EveryFrameDecoder, SequencesDoNotSeeEachOther) {
  const ModelDescription d = wider(small_frames_description());
  const StoredModel stored = stored_model(d, 7);
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    FrameDecoder alone(stored, "m", {precision, 1, 1}), together(stored, "m", {precision, 2, 3});
    std::vector<Ids> streams;
    for (std::uint64_t s = 0; s < 3; ++s) {
      streams.push_back(some_ids(d, 8 + s, 6));
      // Of different lengths so far.
      together.begin(static_cast<std::int64_t>(s), kPrefix, {});
      for (std::size_t i = 0; i < 8 + 5 * s; ++i)
        together.push(static_cast<std::int64_t>(s), streams[s][i]);
    }
    for (int step = 0; step < 12; ++step) {
      std::vector<std::int64_t> asked;
      for (std::size_t s = 0; s < 3; ++s)
        if ((8 + 5 * s + static_cast<std::size_t>(step)) % kPerFrame != 6)
          asked.push_back(static_cast<std::int64_t>(s));
      const auto logits = together.logits(asked);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        const auto s = static_cast<std::size_t>(asked[i]);
        alone.begin(0, kPrefix, {});
        const std::size_t done = 8 + 5 * s + static_cast<std::size_t>(step);
        for (std::size_t k = 0; k < done; ++k) alone.push(0, streams[s][k]);
        EXPECT_EQ(alone.logits({0})[0], logits[i]) << "sequence " << s << ", step " << step;
      }
      for (std::size_t s = 0; s < 3; ++s)
        together.push(static_cast<std::int64_t>(s),
                      streams[s][8 + 5 * s + static_cast<std::size_t>(step)]);
    }
  }
}

TEST(FrameDecoder, LowerPrecisionsAreClose) {
  const ModelDescription d = wider(small_frames_description());
  const StoredModel stored = stored_model(d, 11);
  const Ids ids = some_ids(d, 12);
  const auto expected = full_logits(stored, ids);
  for (const auto& [precision, most] :
       {std::pair{Precision::bf16, 0.02}, std::pair{Precision::int8, 0.1}}) {
    FrameDecoder decoder(stored, "m", {precision, 2, 1});
    decoder.begin(0, kPrefix, before(ids));
    double distance = 0, spread = 0;
    for (std::size_t t = 0; t + kBefore * kPerFrame < ids.size(); ++t) {
      if (t % kPerFrame + 1 < kPerFrame) {
        const auto& got = decoder.logits({0})[0];
        double mean = 0;
        for (const float v : expected[t]) mean += v / static_cast<double>(got.size());
        for (std::size_t i = 0; i < got.size(); ++i) {
          distance += std::abs(static_cast<double>(got[i]) - expected[t][i]);
          spread += std::abs(expected[t][i] - mean);
        }
      }
      decoder.push(0, ids[kBefore * kPerFrame + t]);
    }
    EXPECT_LT(distance / spread, most);
    EXPECT_GT(distance, 0);
  }
}

TEST(FrameDecoder, RerunsTheStoredSelfTest) {
  const ModelDescription d = wider(small_frames_description());
  StoredModel stored = stored_model(d, 13);
  const Ids ids = some_ids(d, 14, 20);
  const auto model = load_transformer(stored, "m");
  const auto window = [&](std::size_t count) { return window_input(d, kPrefix, ids, 0, count); };
  stored.self_test = make_self_test(*model, {window(72), window(70)});
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
    EXPECT_NO_THROW(FrameDecoder(stored, "m", {precision, 1, 1}));
  StoredModel other = stored_model(d, 15);
  other.self_test = stored.self_test;
  EXPECT_TRUE(
      contains(refusal<DataError>([&] { FrameDecoder(other, "m", {}); }), "self-test fails"));
  StoredModel odd = stored;
  odd.self_test[0].input = window(76);  // then comes a separator
  EXPECT_TRUE(
      contains(refusal<DataError>([&] { FrameDecoder(odd, "m", {}); }), "no bin can follow"));
  odd.self_test[0].input = window(70);
  for (std::int32_t& frame : odd.self_test[0].input.frame) frame = 1;  // no prefix
  EXPECT_TRUE(contains(refusal<DataError>([&] { FrameDecoder(odd, "m", {}); }), "prefix"));
}

TEST(FrameDecoder, MissingAndOddTensorsAreNamed) {
  const StoredModel stored = stored_model(wider(small_frames_description()), 16);
  for (const auto& [name, tensor] : stored.tensors) {
    StoredModel bad = stored;
    bad.tensors.erase(name);
    EXPECT_TRUE(contains(refusal<DataError>([&] { FrameDecoder(bad, "m", {}); }), name));
    bad.tensors[name] = {{1}, {0.f}};
    EXPECT_TRUE(contains(refusal<DataError>([&] { FrameDecoder(bad, "m", {}); }), name));
  }
  StoredModel more = stored;
  more.tensors["more"] = {{1}, {0.f}};
  EXPECT_THROW(FrameDecoder(more, "m", {}), DataError);
}

}  // namespace

}  // namespace mocaplm::frame_decoder_test
