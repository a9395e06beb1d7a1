// The decoding engine against the trainable transformer, position by position, and its kernels
// against plain loops.
#include "generate/engine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "generate/kernels.h"
#include "model/transformer/weights.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace mocaplm {

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

ModelInput part(const ModelInput& input, std::size_t begin, std::size_t end) {
  ModelInput out;
  for (auto list :
       {&ModelInput::token, &ModelInput::frame, &ModelInput::channel, &ModelInput::centre,
        &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    (out.*list).assign((input.*list).begin() + static_cast<std::ptrdiff_t>(begin),
                       (input.*list).begin() + static_cast<std::ptrdiff_t>(end));
  return out;
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
      engine.feed_silently(part(input, at, end));
    } else {
      expect_row(engine.feed(part(input, at, end)), expected[end - 1],
                 "position " + std::to_string(end - 1));
    }
    at = end;
    ASSERT_EQ(engine.length(), static_cast<std::int64_t>(at));
  }
}

class EveryKernel : public testing::TestWithParam<KernelLevel> {
 protected:
  void SetUp() override {
    if (GetParam() > best_kernel_level())
      GTEST_SKIP() << "this processor has no " << to_string(GetParam());
    set_kernel_level(GetParam());
  }
  void TearDown() override {
    set_kernel_level(best_kernel_level());
    set_engine_threads(1);
  }
};

INSTANTIATE_TEST_SUITE_P(Levels, EveryKernel,
                         testing::Values(KernelLevel::plain, KernelLevel::avx2,
                                         KernelLevel::avx512),
                         [](const auto& info) {
                           return info.param == KernelLevel::avx512 ? "avx512"
                                  : info.param == KernelLevel::avx2 ? "avx2"
                                                                    : "plain";
                         });

TEST_P(EveryKernel, EngineGivesTheTransformersLogits) {
  for (const ModelDescription& variant : all_variants()) {
    const ModelDescription d = wider(variant);
    SCOPED_TRACE(variant_name(d));
    const StoredModel stored = stored_model(d, 1);
    const ModelInput input = some_window(d, 2);
    const auto expected = full_logits(stored, input);
    set_engine_threads(1);
    Engine engine(stored, "m");
    for (const int threads : {1, 2}) {
      set_engine_threads(threads);  // raised after the engine was made
      expect_pieces(engine, input, expected, std::vector<std::size_t>(input.size(), 1));
      for (const std::size_t first : {1, 5, 63, 64, 65, 128, 130, 149})
        expect_pieces(engine, input, expected, {first, 1, 3, 1, 1, 2, 70, 1});
      expect_pieces(engine, input, expected, {input.size()});
    }
    if (HasFatalFailure()) return;
  }
}

TEST_P(EveryKernel, PackedLinearIsTheMatrixProduct) {
  Random random(3);
  const auto numbers = [&](std::int64_t count) {
    std::vector<float> values;
    for (std::int64_t i = 0; i < count; ++i) values.push_back(static_cast<float>(random.normal()));
    return values;
  };
  for (const int threads : {1, 2}) {
    set_engine_threads(threads);
    for (const std::int64_t out : {1, 31, 32, 33, 100, 260})
      for (const std::int64_t in : {1, 7, 64, 129})
        for (const std::int64_t rows : {1, 2, 3, 4, 5, 9}) {
          const std::vector<float> weight = numbers(out * in), bias = numbers(out),
                                   x = numbers(rows * in);
          const PackedLinear linear(weight.data(), bias.data(), out, in);
          std::vector<float> y(static_cast<std::size_t>(rows * out + 8), 77.f);
          linear.apply(x.data(), y.data(), rows);
          for (std::int64_t r = 0; r < rows; ++r)
            for (std::int64_t o = 0; o < out; ++o) {
              double sum = bias[static_cast<std::size_t>(o)];
              for (std::int64_t k = 0; k < in; ++k)
                sum += static_cast<double>(x[static_cast<std::size_t>(r * in + k)]) *
                       weight[static_cast<std::size_t>(o * in + k)];
              ASSERT_NEAR(y[static_cast<std::size_t>(r * out + o)], sum, 1e-4)
                  << out << " x " << in << ", row " << r << ", output " << o;
            }
          for (std::int64_t i = rows * out; i < rows * out + 8; ++i)
            ASSERT_EQ(y[static_cast<std::size_t>(i)], 77.f) << "written past the end";
        }
  }
}

TEST_P(EveryKernel, AttendIsTheSoftmaxAverage) {
  Random random(4);
  for (const std::int64_t width : {1, 7, 16, 64})
    for (const std::int64_t count : {1, 2, 33, 200}) {
      const std::int64_t stride = width + 5;
      std::vector<float> query, keys, values;
      for (std::int64_t i = 0; i < width; ++i)
        query.push_back(static_cast<float>(2 * random.normal()));
      for (std::int64_t i = 0; i < count * stride; ++i) {
        keys.push_back(static_cast<float>(2 * random.normal()));
        values.push_back(static_cast<float>(random.normal()));
      }
      std::vector<double> p, expected(static_cast<std::size_t>(width), 0.0);
      double total = 0;
      for (std::int64_t t = 0; t < count; ++t) {
        double score = 0;
        for (std::int64_t i = 0; i < width; ++i)
          score += static_cast<double>(query[static_cast<std::size_t>(i)]) *
                   keys[static_cast<std::size_t>(t * stride + i)];
        p.push_back(std::exp(score / std::sqrt(static_cast<double>(width))));
        total += p.back();
      }
      for (std::int64_t t = 0; t < count; ++t)
        for (std::int64_t i = 0; i < width; ++i)
          expected[static_cast<std::size_t>(i)] += p[static_cast<std::size_t>(t)] / total *
                                                   values[static_cast<std::size_t>(t * stride + i)];
      std::vector<float> scores(static_cast<std::size_t>(count)),
          out(static_cast<std::size_t>(width));
      attend(query.data(), keys.data(), values.data(), count, stride, width, scores.data(),
             out.data());
      for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(out[i], expected[i], 1e-4);
    }
}

TEST(Kernels, LayerNormAndGeluAreTheirFormulas) {
  Random random(5);
  const std::int64_t rows = 3, width = 37;
  std::vector<float> x, weight, bias, y(static_cast<std::size_t>(rows * width));
  for (std::int64_t i = 0; i < rows * width; ++i)
    x.push_back(static_cast<float>(1000 + 3 * random.normal()));
  for (std::int64_t i = 0; i < width; ++i) {
    weight.push_back(static_cast<float>(random.normal()));
    bias.push_back(static_cast<float>(random.normal()));
  }
  layer_norm(x.data(), weight.data(), bias.data(), rows, width, y.data());
  for (std::int64_t r = 0; r < rows; ++r) {
    const float *row = x.data() + r * width, *out = y.data() + r * width;
    double mean = 0, square = 0;
    for (std::int64_t i = 0; i < width; ++i) mean += row[i] / static_cast<double>(width);
    for (std::int64_t i = 0; i < width; ++i)
      square += (row[i] - mean) * (row[i] - mean) / static_cast<double>(width);
    for (std::int64_t i = 0; i < width; ++i) {
      const auto at = static_cast<std::size_t>(i);
      ASSERT_NEAR(out[i], (row[i] - mean) / std::sqrt(square + 1e-5) * weight[at] + bias[at], 1e-4);
    }
  }
  std::vector<float> v;
  for (double value = -12; value <= 12; value += 0.01) v.push_back(static_cast<float>(value));
  std::vector<float> g = v;
  gelu(g.data(), static_cast<std::int64_t>(g.size()));
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double z = v[i];
    ASSERT_NEAR(g[i], 0.5 * z * (1 + std::erf(z / std::sqrt(2.0))), 1e-5) << z;
  }
}

TEST(Kernels, ALevelThatTheProcessorLacksIsNotTaken) {
  set_kernel_level(KernelLevel::avx512);
  EXPECT_EQ(kernel_level(), best_kernel_level());
  set_kernel_level(KernelLevel::plain);
  EXPECT_EQ(kernel_level(), KernelLevel::plain);
  set_kernel_level(best_kernel_level());
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
  stored.self_test[0].logits[4] += 1;
  EXPECT_TRUE(contains(refusal<DataError>([&] { Engine(stored, "m"); }), "self-test fails"));
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

}  // namespace mocaplm
