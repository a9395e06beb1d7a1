// AdamW against its formulas, and its stored state, sound and damaged.
#include "train/optimizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/files.h"
#include "common/random.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace mocaplm::optimizer_test {

namespace {

// A matrix, an embedding and a bias.
struct Tiny : torch::nn::Module {
  explicit Tiny(std::int64_t width) {
    at::manual_seed(1);
    matrix = register_parameter("up/weight", at::randn({3, width}));
    table = register_parameter("token_embedding", at::randn({4, width}));
    bias = register_parameter("up/bias", at::randn({3}));
  }
  void set_gradients(std::uint64_t seed, double scale = 1) {
    at::manual_seed(seed);
    for (at::Tensor parameter : parameters())
      parameter.mutable_grad() = at::randn_like(parameter) * scale;
  }
  at::Tensor matrix, table, bias;
};

TrainConfig config(double clip = 0) {
  TrainConfig c;
  c.weight_decay = 0.3;
  c.beta2 = 0.97;
  c.grad_clip = clip;
  return c;
}

// Loshchilov and Hutter 2019, algorithm 2; decay on the matrix alone.
struct PlainAdamW {
  at::Tensor value, first, second;
  double decay;
  void step(const at::Tensor& grad, double rate, int t) {
    first = 0.9 * first + 0.1 * grad;
    second = 0.97 * second + 0.03 * grad * grad;
    value = value - rate * decay * value -
            rate * (first / (1 - std::pow(0.9, t))) /
                ((second / (1 - std::pow(0.97, t))).sqrt() + 1e-8);
  }
};

// f32 takes one pass of our own, everything else LibTorch's operations.
TEST(Optimizer, StepsAreThoseOfAdamWWithDecayOnMatricesOnly) {
  for (const at::ScalarType type : {at::kFloat, at::kDouble}) {
    Tiny model(5);
    model.to(type);
    Optimizer optimizer(model, config());
    std::vector<PlainAdamW> plain;
    for (const at::Tensor& p : model.parameters())
      plain.push_back({p.detach().to(at::kDouble).clone(), at::zeros_like(p, at::kDouble),
                       at::zeros_like(p, at::kDouble), p.is_same(model.matrix) ? 0.3 : 0.0});
    for (int t = 1; t <= 20; ++t) {
      model.set_gradients(static_cast<std::uint64_t>(t));
      const double rate = 0.01 * t;
      for (std::size_t i = 0; i < plain.size(); ++i)
        plain[i].step(model.parameters()[i].grad().to(at::kDouble), rate, t);
      optimizer.step(rate);
    }
    for (std::size_t i = 0; i < plain.size(); ++i)
      EXPECT_LT((model.parameters()[i].detach() - plain[i].value).abs().max().item<double>(), 1e-4)
          << type;
  }
}

double norm_of(const Tiny& model) {
  double square = 0;
  for (const at::Tensor& p : model.parameters()) square += p.grad().square().sum().item<double>();
  return std::sqrt(square);
}

TEST(Optimizer, GradientsAreClippedToTheirNorm) {
  Tiny model(5), shrunk(5);
  Optimizer clipping(model, config(1.5)), free(shrunk, config(0));
  for (const double scale : {10.0, 0.01, 3.0}) {  // the second is short enough
    model.set_gradients(2, scale);
    shrunk.set_gradients(2, scale);
    const double norm = norm_of(model);
    for (at::Tensor p : shrunk.parameters()) p.mutable_grad().mul_(std::min(1.0, 1.5 / norm));
    EXPECT_NEAR(clipping.step(0.1), norm, 1e-5 * norm);
    free.step(0.1);
  }
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT((model.parameters()[i] - shrunk.parameters()[i]).abs().max().item<double>(), 1e-5);
}

TEST(Optimizer, AGradientThatIsNotFiniteChangesNothing) {
  for (const double clip : {0.0, 1.0}) {
    Tiny model(5);
    Optimizer optimizer(model, config(clip));
    model.set_gradients(3);
    model.table.mutable_grad()[1][1] = std::nan("");
    const at::Tensor before = model.matrix.detach().clone();
    EXPECT_FALSE(std::isfinite(optimizer.step(0.1)));
    EXPECT_TRUE(at::equal(model.matrix, before));
  }
}

void some_steps(Tiny& model, Optimizer& optimizer, int count) {
  for (int i = 0; i < count; ++i) {
    model.set_gradients(static_cast<std::uint64_t>(10 + i));
    optimizer.step(0.05);
  }
}

TEST(Optimizer, GoesOnFromItsFileAsIfNothingHadHappened) {
  const TemporaryFolder folder;
  Tiny a(5), b(5);
  Optimizer first(a, config()), second(b, config());
  some_steps(a, first, 3);
  first.save(folder / "optimizer.safetensors");
  {
    const at::NoGradGuard no_grad;
    for (std::size_t i = 0; i < 3; ++i) b.parameters()[i].copy_(a.parameters()[i]);
  }
  second.load(folder / "optimizer.safetensors");
  some_steps(a, first, 2);
  some_steps(b, second, 2);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(at::equal(a.parameters()[i], b.parameters()[i])) << i;
}

TEST(Optimizer, AnotherModelsStateIsRefused) {
  const TemporaryFolder folder;
  Tiny wide(7), narrow(5);
  Optimizer first(wide, config()), second(narrow, config());
  some_steps(wide, first, 2);
  first.save(folder / "optimizer.safetensors");
  const std::string message =
      refusal<DataError>([&] { second.load(folder / "optimizer.safetensors"); });
  EXPECT_TRUE(contains(message, "optimizer.safetensors")) << message;
}

TEST(Optimizer, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string file = (folder / "optimizer.safetensors").string();
  Tiny model(5);
  Optimizer optimizer(model, config());
  some_steps(model, optimizer, 2);
  optimizer.save(file);
  const std::string bytes = read_file(file);
  Random random(1);
  int refusals = 0;
  for (int round = 0; round < 300; ++round) {
    std::string damaged = bytes;
    if (round % 3 == 0)
      damaged.resize(random.below(bytes.size()));
    else
      damaged[random.below(bytes.size())] = static_cast<char>(random.below(256));
    put(file, damaged);
    Tiny fresh(5);
    Optimizer other(fresh, config());
    refusals += reads_or_refuses([&] { other.load(file); }, "optimizer.safetensors") ? 0 : 1;
  }
  EXPECT_GT(refusals, 100);
  refusal<DataError>([&] { optimizer.load(folder / "absent.safetensors"); });
}

}  // namespace

}  // namespace mocaplm::optimizer_test
