// The transformer against an independent forward pass in double precision, its causality, its
// gradients.
#include "model/transformer/transformer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/masked_input.h"
#include "model/transformer/weights.h"
#include "support/plain_transformer.h"
#include "support/random_model.h"
#include "support/small_models.h"
#include "support/tensors.h"

namespace mocaplm::transformer_test {

namespace {

std::vector<std::int32_t> full_stream(const ModelDescription& d, Random& random) {
  return random_stream(d.shape, d.config.block_size / d.shape.tokens_per_frame(), random);
}

ModelInput full_window(const ModelDescription& d, const std::vector<std::int32_t>& ids) {
  return window_input(d, {2}, ids, 0,
                      std::min(ids.size(), static_cast<std::size_t>(d.config.block_size - 1)));
}

Batch random_batch(const ModelDescription& d, std::int64_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<ModelInput> inputs;
  std::vector<std::vector<std::int32_t>> targets;
  for (std::int64_t b = 0; b < size; ++b) {
    const std::vector<std::int32_t> ids = full_stream(d, random);
    inputs.push_back(full_window(d, ids));
    targets.emplace_back(ids.begin(), ids.end());
    targets.back().resize(inputs.back().size(), -1);
    targets.back()[3] = -1;
  }
  return stack(inputs, targets);
}

// The model written down a second time.
class Reference : public PlainTransformer {
 public:
  Reference(const ModelDescription& d, const TensorMap& weights)
      : PlainTransformer(weights), d_(d) {}

  // Final normalised states; `extra` (B, F, C) follows the window, seeing everything.
  at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {}) const {
    at::Tensor x = rows("token_embedding", batch.token);
    if (d_.config.position == "custom")
      x = x + rows("frame_embedding", batch.frame) + rows("channel_embedding", batch.channel);
    else
      x = x + rows("position_embedding", at::arange(batch.token.size(1)).expand_as(batch.token));
    if (d_.config.history)
      x = x + rows("history.surprise", batch.surprise) + rows("history.velocity", batch.velocity) +
          rows("history.last_surprise", batch.last_surprise);
    if (extra.defined()) x = at::cat({x, extra.to(at::kDouble)}, 1);
    const std::int64_t free = d_.config.objective == "masked" ? x.size(1)
                              : extra.defined()               ? extra.size(1)
                                                              : 0;
    return norm("ln", blocks("block.", d_.config.n_layer, d_.config.n_head, x, free));
  }

  at::Tensor logits(const at::Tensor& hidden, const Batch& batch) const {
    const at::Tensor absolute = linear("head", hidden).flatten(0, 1);
    at::Tensor offsets;
    if (d_.config.output == "extrapolation") offsets = linear("offset_head", hidden).flatten(0, 1);
    return combined_logits(absolute, offsets, batch.centre.flatten(),
                           {d_.shape.first_bin, d_.shape.bins})
        .view({hidden.size(0), hidden.size(1), -1});
  }

 private:
  at::Tensor rows(const std::string& name, const at::Tensor& index) const {
    return weight(name)
        .index_select(0, index.flatten())
        .view({index.size(0), index.size(1), d_.config.n_embd});
  }
  ModelDescription d_;
};

TEST(Transformer, AgreesWithTheFormulasInEveryVariant) {
  for (const ModelDescription& d : all_variants()) {
    const auto model = random_model(d, 1);
    const Reference reference(d, random_weights(d, 1));
    const Batch batch = random_batch(d, 2, 2);
    EXPECT_LT(largest_difference(logits_of(*model, batch),
                                 reference.logits(reference.hidden(batch), batch)),
              1e-4)
        << variant_name(d);
  }
}

TEST(Transformer, GradientsOfEveryParameterAgreeWithTheFormulas) {
  for (const ModelDescription& d : all_variants()) {
    const auto model = random_model(d, 3);
    const Reference reference(d, random_weights(d, 3));
    const Batch batch = random_batch(d, 2, 4);
    model->train();
    model->loss(model->hidden(batch), batch).sum().backward();
    plain_loss(reference.logits(reference.hidden(batch), batch), batch.target).sum().backward();
    expect_same_gradients(*model, reference, 1e-4, variant_name(d));
  }
}

TEST(Transformer, GradientsAgreeWithFiniteDifferences) {
  // Along each parameter's own gradient the slope is its norm: the largest signal f32 can give.
  const ModelDescription d = small_description();
  const auto model = random_model(d, 5);
  const Batch batch = random_batch(d, 2, 6);
  model->loss(model->hidden(batch), batch).sum().backward();
  const at::NoGradGuard no_grad;
  const auto total = [&] {
    return model->loss(model->hidden(batch), batch).to(at::kDouble).sum().item<double>();
  };
  for (const auto& item : model->named_parameters()) {
    const at::Tensor grad = item.value().grad();
    const double norm = grad.norm().item<double>();
    ASSERT_GT(norm, 0) << item.key();
    at::Tensor value = item.value();
    const at::Tensor before = value.clone();
    const double step = std::min(2e-2, 0.1 / norm);
    value.copy_(before + grad * (step / norm));
    const double up = total();
    value.copy_(before - grad * (step / norm));
    const double down = total();
    value.copy_(before);
    EXPECT_NEAR((up - down) / (2 * step), norm, 0.02 * norm + 0.02) << item.key();
  }
}

TEST(Transformer, ATokenNeverChangesWhatComesBeforeIt) {
  for (ModelDescription d : all_variants()) {
    d.config.block_size = 200;  // more than one block of queries
    d.config.n_layer = 3;
    const auto model = random_model(d, 7);
    Random random(8);
    const std::vector<std::int32_t> ids = full_stream(d, random);
    const at::Tensor before = logits_of(*model, stack({full_window(d, ids)}));
    for (const std::size_t at : {0, 1, 60, 127, 128, 170, 198}) {
      std::vector<std::int32_t> changed = ids;
      changed[at] = changed[at] == 5 ? 9 : 5;
      const at::Tensor after = logits_of(*model, stack({full_window(d, changed)}));
      const auto position = static_cast<std::int64_t>(at) + 1;  // behind the start token
      EXPECT_LT(largest_difference(after.narrow(1, 0, position), before.narrow(1, 0, position)),
                1e-6)
          << variant_name(d) << ", token " << at;
      EXPECT_GT(largest_difference(after.narrow(1, position, 1), before.narrow(1, position, 1)),
                1e-4)
          << variant_name(d) << ", token " << at;
    }
  }
}

TEST(Transformer, FreeTokensSeeEverythingAndAreSeenByNoMotion) {
  ModelDescription d = small_description();
  d.config.block_size = 160;
  const auto model = random_model(d, 9);
  const at::NoGradGuard no_grad;
  Random random(10);
  const std::vector<std::int32_t> ids = full_stream(d, random);
  const Batch batch = stack({full_window(d, ids)});
  const std::int64_t length = batch.token.size(1);
  at::manual_seed(11);
  const at::Tensor extra = at::randn({1, 2, d.config.n_embd});
  const at::Tensor with = model->hidden(batch, extra);
  ASSERT_EQ(with.size(1), length + 2);
  EXPECT_LT(largest_difference(with.narrow(1, 0, length), model->hidden(batch)), 1e-6);
  const Reference reference(d, random_weights(d, 9));
  EXPECT_LT(largest_difference(with, reference.hidden(batch, extra)), 1e-4);
  for (const std::size_t at : {0, 80, 157}) {
    std::vector<std::int32_t> changed = ids;
    changed[at] = changed[at] == 5 ? 9 : 5;
    const at::Tensor after = model->hidden(stack({full_window(d, changed)}), extra);
    for (const std::int64_t token : {0, 1})
      EXPECT_GT(largest_difference(after[0][length + token], with[0][length + token]), 1e-5);
  }
  for (const std::int64_t token : {0, 1}) {  // each sees the other
    at::Tensor other = extra.clone();
    other[0][token] += at::randn({d.config.n_embd});
    const at::Tensor after = model->hidden(batch, other);
    EXPECT_GT(largest_difference(after[0][length + 1 - token], with[0][length + 1 - token]), 1e-5);
  }
}

// A window of a masked model and, as targets, what is hidden of it.
Batch masked_batch(const ModelDescription& d, std::int64_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<ModelInput> inputs;
  std::vector<std::vector<std::int32_t>> targets;
  for (std::int64_t b = 0; b < size; ++b) {
    std::vector<std::int32_t> ids = full_stream(d, random);
    ids.resize(static_cast<std::size_t>(d.config.block_size - 1));
    targets.emplace_back(ids.size() + 1, -1);
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (ids[i] >= d.shape.first_bin && random.below(4) == 0) {
        targets.back()[1 + i] = ids[i];
        ids[i] = 1;
      }
    inputs.push_back(masked_input(d, {2}, ids));
  }
  return stack(inputs, targets);
}

TEST(MaskedTransformer, AgreesWithTheFormulasInEveryVariant) {
  for (ModelDescription d : all_variants()) {
    d.config.objective = "masked";
    const auto model = random_model(d, 21);
    const Reference reference(d, random_weights(d, 21));
    const Batch batch = masked_batch(d, 2, 22);
    model->train();
    const at::Tensor expected = reference.logits(reference.hidden(batch), batch);
    EXPECT_LT(largest_difference(logits_of(*model, batch), expected), 1e-4) << variant_name(d);
    const at::Tensor loss = model->loss(model->hidden(batch), batch);
    loss.sum().backward();
    const at::Tensor wanted = plain_loss(expected, batch.target);
    EXPECT_LT(largest_difference(loss, wanted), 1e-4) << variant_name(d);
    wanted.sum().backward();
    expect_same_gradients(*model, reference, 1e-4, variant_name(d));
  }
}

TEST(MaskedTransformer, EveryPositionSeesTheWholeWindow) {
  for (ModelDescription d : all_variants()) {
    d.config.objective = "masked";
    d.config.block_size = 200;
    const auto model = random_model(d, 23);
    Random random(24);
    std::vector<std::int32_t> ids = full_stream(d, random);
    ids.resize(199);
    const at::Tensor before = logits_of(*model, stack({masked_input(d, {2}, ids)}));
    for (const std::size_t at : {0, 60, 196}) {
      std::vector<std::int32_t> changed = ids;
      changed[at] = changed[at] == 5 ? 9 : 5;
      const at::Tensor after = logits_of(*model, stack({masked_input(d, {2}, changed)}));
      for (const std::int64_t position : {1, 100, 199})
        EXPECT_GT(largest_difference(after.narrow(1, position, 1), before.narrow(1, position, 1)),
                  1e-7)
            << variant_name(d) << ", token " << at << ", position " << position;
    }
  }
}

TEST(Transformer, Bf16IsCloseToF32) {
  const ModelDescription d = small_description();
  const auto model = random_model(d, 12);
  const Batch batch = random_batch(d, 4, 13);
  const auto mean_loss = [&] {
    const at::NoGradGuard no_grad;
    return model->loss(model->hidden(batch), batch).mean().item<double>();
  };
  const double exact = mean_loss();
  model->set_precision(at::kBFloat16);
  EXPECT_NEAR(mean_loss(), exact, 0.02 * exact);
  const at::Tensor hidden = model->hidden(batch);
  EXPECT_EQ(hidden.scalar_type(), at::kFloat);
  model->loss(hidden, batch).sum().backward();
  for (const at::Tensor& parameter : model->parameters()) {
    EXPECT_EQ(parameter.grad().scalar_type(), at::kFloat);
    EXPECT_TRUE(at::isfinite(parameter.grad()).all().item<bool>());
  }
}

TEST(Transformer, DropoutFollowsTheSeedAndOnlyActsInTraining) {
  ModelDescription d = small_description();
  d.config.dropout = 0.2;
  const auto model = random_model(d, 14);
  const Batch batch = random_batch(d, 2, 15);
  const at::Tensor eval = logits_of(*model, batch);
  EXPECT_TRUE(at::equal(logits_of(*model, batch), eval));
  model->train();
  const auto draw = [&](std::uint64_t seed) {
    at::manual_seed(seed);
    return logits_of(*model, batch);
  };
  EXPECT_TRUE(at::equal(draw(1), draw(1)));
  EXPECT_GT(largest_difference(draw(1), draw(2)), 1e-2);
  EXPECT_GT(largest_difference(draw(1), eval), 1e-2);
}

TEST(Transformer, FreshWeightsAreThoseOfGpt2) {
  ModelDescription d = small_description();
  d.config.n_embd = 64;
  at::manual_seed(16);
  const auto model = std::make_shared<Transformer>(d);
  for (const auto& [name, tensor] : export_weights(*model)) {
    double mean = 0, square = 0;
    for (const float v : tensor.values) mean += v, square += static_cast<double>(v) * v;
    mean /= static_cast<double>(tensor.size());
    const double deviation = std::sqrt(square / static_cast<double>(tensor.size()) - mean * mean);
    const bool norm = name.find("ln") != std::string::npos;
    const bool residual =
        name.find("proj") != std::string::npos || name.find("down") != std::string::npos;
    if (tensor.shape.size() == 2) {
      EXPECT_NEAR(deviation, residual ? 0.02 / std::sqrt(4.0) : 0.02, 0.002) << name;
    } else {
      EXPECT_EQ(deviation, 0) << name;
      EXPECT_EQ(mean, norm && name.find("weight") != std::string::npos ? 1 : 0) << name;
    }
  }
  EXPECT_NEAR(logits_of(*model, random_batch(d, 1, 17)).abs().max().item<double>(), 0, 1);
}

}  // namespace

}  // namespace mocaplm::transformer_test
