// The decoding engine against the trainable transformer, position by position, in every precision
// and with every set of instructions.
#include "generate/engine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/transformer/weights.h"
#include "support/kernel_levels.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace mocaplm::engine_test {

namespace {

// Wide and long enough that work is shared among threads and prompts take several blocks of rows.
ModelDescription wider(ModelDescription d) {
  d.config.n_embd = 48;
  d.config.n_head = 3;
  d.config.block_size = 150;
  return d;
}

ModelInput some_window(const ModelDescription& d, std::uint64_t seed) {
  Random random(seed);
  const std::vector<std::int32_t> ids = random_stream(d.shape, d.config.block_size, random);
  return window_input(d, {2, 1}, ids, 8, static_cast<std::size_t>(d.config.block_size) - 2);
}

StoredModel stored_model(const ModelDescription& d, std::uint64_t seed) {
  StoredModel stored;
  stored.description = d;
  stored.tensors = random_weights(d, seed);
  return stored;
}

// logits[position][id] of the trainable transformer's full forward pass.
std::vector<std::vector<float>> full_logits(const StoredModel& stored, const ModelInput& input) {
  const at::NoGradGuard no_grad;
  const auto model = load_transformer(stored, "m");
  const Batch batch = stack({input});
  const at::Tensor logits = model->logits(model->hidden(batch), batch)[0].contiguous();
  std::vector<std::vector<float>> rows;
  for (std::int64_t t = 0; t < logits.size(0); ++t) {
    const float* row = logits.data_ptr<float>() + t * logits.size(1);
    rows.emplace_back(row, row + logits.size(1));
  }
  return rows;
}

void expect_row(const std::vector<float>& got, const std::vector<float>& expected,
                const std::string& what) {
  ASSERT_EQ(got.size(), expected.size());
  float worst = 0;
  for (std::size_t i = 0; i < got.size(); ++i)
    worst = std::max(worst, std::abs(got[i] - expected[i]));
  ASSERT_LT(worst, 1e-3f) << what;
}

// Feeds the window in the given pieces after a reset; each piece's last position is compared.
void expect_pieces(Engine& engine, const ModelInput& input,
                   const std::vector<std::vector<float>>& expected,
                   const std::vector<std::size_t>& pieces) {
  engine.reset();
  std::size_t at = 0;
  for (std::size_t i = 0; i < pieces.size() && at < input.size(); ++i) {
    const std::size_t end = std::min(at + pieces[i], input.size());
    if (i % 3 == 2) {
      engine.feed_silently(slice(input, at, end));
    } else {
      expect_row(engine.feed(slice(input, at, end)), expected[end - 1],
                 "position " + std::to_string(end - 1));
    }
    at = end;
    ASSERT_EQ(engine.length(), static_cast<std::int64_t>(at));
  }
}

class EveryEngine : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Levels, EveryEngine, all_levels(), level_name);

TEST_P(EveryEngine, GivesTheTransformersLogits) {
  for (const ModelDescription& variant : all_variants()) {
    const ModelDescription d = wider(variant);
    SCOPED_TRACE(variant_name(d));
    const StoredModel stored = stored_model(d, 1);
    const ModelInput input = some_window(d, 2);
    const auto expected = full_logits(stored, input);
    for (const int threads : {1, 2}) {
      Engine engine(stored, "m", {Precision::f32, threads, 1});
      expect_pieces(engine, input, expected, std::vector<std::size_t>(input.size(), 1));
      for (const std::size_t first : {1, 5, 63, 64, 65, 128, 130, 149})
        expect_pieces(engine, input, expected, {first, 1, 3, 1, 1, 2, 70, 1});
      expect_pieces(engine, input, expected, {input.size()});
    }
    if (HasFatalFailure()) return;
  }
}

// Root mean square distance over the spread of the expected logits.
double relative_error(Engine& engine, const ModelInput& input,
                      const std::vector<std::vector<float>>& expected) {
  engine.reset();
  double error = 0, spread = 0;
  for (std::size_t t = 0; t < input.size(); ++t) {
    const std::vector<float>& got = engine.feed(slice(input, t, t + 1));
    for (std::size_t i = 0; i < got.size(); ++i) {
      error += std::pow(static_cast<double>(got[i]) - expected[t][i], 2);
      spread += std::pow(static_cast<double>(expected[t][i]), 2);
    }
  }
  return std::sqrt(error / spread);
}

TEST_P(EveryEngine, LowerPrecisionsAreClose) {
  const ModelDescription d = wider(small_description());
  const StoredModel stored = stored_model(d, 3);
  const ModelInput input = some_window(d, 4);
  const auto expected = full_logits(stored, input);
  Engine half(stored, "m", {Precision::bf16, 1, 1}), byte(stored, "m", {Precision::int8, 1, 1});
  const double half_error = relative_error(half, input, expected),
               byte_error = relative_error(byte, input, expected);
  EXPECT_LT(half_error, 0.02);
  EXPECT_LT(byte_error, 0.05);
  EXPECT_GT(half_error, 1e-5) << "is it f32 after all?";
  EXPECT_GT(byte_error, 1e-5) << "is it f32 after all?";
}

// A sequence's logits are bitwise the same with other sequences beside it, with any number of
// threads, and fed in any pieces.
TEST_P(EveryEngine, SequencesDoNotSeeEachOther) {
  const ModelDescription d = wider(small_description());
  const StoredModel stored = stored_model(d, 5);
  const std::vector<ModelInput> inputs = {some_window(d, 6), some_window(d, 7), some_window(d, 8)};
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    Engine alone(stored, "m", {precision, 1, 1}), together(stored, "m", {precision, 2, 3});
    std::vector<std::vector<std::vector<float>>> expected(3);
    for (std::size_t s = 0; s < 3; ++s) {
      alone.reset();
      for (std::size_t t = 0; t < inputs[s].size(); ++t)
        expected[s].push_back(alone.feed(slice(inputs[s], t, t + 1)));
    }
    std::vector<std::size_t> at(3, 0);
    Random random(9);
    for (int step = 0; step < 40; ++step) {
      std::vector<ModelInput> pieces(3);
      std::vector<Engine::Feed> feeds;
      for (const std::size_t s : {2, 0, 1}) {
        const std::size_t end = std::min(at[s] + 1 + random.below(5), inputs[s].size());
        if (random.below(4) == 0 || end == at[s]) continue;
        pieces[s] = slice(inputs[s], at[s], end);
        at[s] = end;
        feeds.push_back({static_cast<std::int64_t>(s), &pieces[s]});
      }
      if (feeds.empty()) continue;
      const auto& logits = together.feed(feeds);
      ASSERT_EQ(logits.size(), feeds.size());
      for (std::size_t f = 0; f < feeds.size(); ++f) {
        const auto s = static_cast<std::size_t>(feeds[f].sequence);
        ASSERT_EQ(logits[f], expected[s][at[s] - 1]) << to_string(precision) << " " << step;
      }
    }
  }
}

// Wide enough that every thread of two or three has heads of its own, and what is read is asked for
// ahead; three threads share heads and panels unevenly.
TEST_P(EveryEngine, HeadsOfItsOwnGiveTheSameBits) {
  ModelDescription d = wider(small_description());
  d.config.n_embd = 512;
  d.config.n_head = 8;
  d.config.block_size = 70;
  const StoredModel stored = stored_model(d, 10);
  const std::vector<ModelInput> inputs = {some_window(d, 11), some_window(d, 12)};
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8}) {
    Engine alone(stored, "m", {precision, 1, 2});
    for (const int threads : {2, 3, 4}) {
      Engine shared(stored, "m", {precision, threads, 2});
      alone.reset(0), alone.reset(1);
      for (std::size_t t = 0; t < 16; ++t) {
        const ModelInput first = slice(inputs[0], t, t + 1), second = slice(inputs[1], t, t + 1);
        const std::vector<Engine::Feed> feeds = {{0, &first}, {1, &second}};
        const auto expected = alone.feed(feeds);
        ASSERT_EQ(shared.feed(feeds), expected) << to_string(precision) << " " << threads;
      }
    }
  }
}

TEST(Engine, RefusesImpossibleNumbersOfSequences) {
  const StoredModel stored = stored_model(small_description(), 1);
  EXPECT_THROW(Engine(stored, "m", {Precision::f32, 1, 0}), UsageError);
  EXPECT_THROW(Engine(stored, "m", {Precision::f32, 1, Engine::kMaxSequences + 1}), UsageError);
}

TEST(Engine, RerunsTheStoredSelfTest) {
  const ModelDescription d = small_description();
  StoredModel stored = stored_model(d, 6);
  Random random(7);
  const auto model = load_transformer(stored, "m");
  stored.self_test =
      make_self_test(*model, {window_input(d, {2}, random_stream(d.shape, 5, random), 0, 20)});
  Engine engine(stored, "m");
  EXPECT_EQ(engine.length(), 0);
  EXPECT_EQ(engine.capacity(), 24);
  for (const Precision precision : {Precision::bf16, Precision::int8})
    EXPECT_NO_THROW(Engine(stored, "m", {precision, 1, 1}));
  stored.self_test[0].logits[4] += 1;
  EXPECT_TRUE(contains(refusal<DataError>([&] { Engine(stored, "m"); }), "self-test fails"));
  // Rounding does not excuse other weights.
  StoredModel other = stored;
  other.tensors = random_weights(d, 99);
  for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
    EXPECT_TRUE(contains(refusal<DataError>([&] {
                           Engine(other, "m", {precision, 1, 1});
                         }),
                         "self-test fails"));
  stored.self_test[0].input.frame[4] = 9;
  EXPECT_TRUE(contains(refusal<DataError>([&] { Engine(stored, "m"); }), "frame 9"));
}

TEST(Engine, MissingAndOddTensorsAreNamed) {
  const ModelDescription d = small_description();
  const StoredModel good = stored_model(d, 8);
  for (const auto& [name, tensor] : good.tensors) {
    StoredModel bad = good;
    bad.tensors.erase(name);
    EXPECT_TRUE(contains(refusal<DataError>([&] { Engine(bad, "m"); }), name));
    bad = good;
    bad.tensors[name].shape.push_back(1);
    EXPECT_TRUE(contains(refusal<DataError>([&] { Engine(bad, "m"); }), name));
  }
  StoredModel more = good;
  more.tensors["classes.weight"] = {{1}, {0}};
  EXPECT_THROW(Engine(more, "m"), DataError);
}

}  // namespace

}  // namespace mocaplm::engine_test
