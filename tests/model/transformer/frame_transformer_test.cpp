// The frame model against a plain reading of its definition, one channel after the other in double
// precision; causality; gradients; unfinished frames.
#include "model/transformer/frame_transformer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/angles.h"
#include "support/plain_transformer.h"
#include "support/random_model.h"
#include "support/small_models.h"
#include "support/tensors.h"

namespace mocaplm::frame_transformer_test {

namespace {

using Ids = std::vector<std::int32_t>;

std::vector<ModelDescription> variants() {
  ModelDescription forgetful = small_frames_description();
  forgetful.config.memory_layer = 0;
  return {small_frames_description(), small_frames_description("absolute"),
          small_frames_description("extrapolation", false), forgetful};
}

// A stream of which the first frames lie before the window, as they do within a clip.
constexpr std::int64_t kBefore = 3;
constexpr std::int32_t kHidden = 1;  // the mask token

Ids random_ids(const ModelDescription& d, std::uint64_t seed) {
  Random random(seed);
  return random_stream(d.shape, kBefore + frames_in_window(d), random);
}

ModelInput window(const ModelDescription& d, const Ids& ids, std::size_t count = 0) {
  const auto first = static_cast<std::size_t>(kBefore * d.shape.tokens_per_frame());
  return window_input(d, {2}, ids, first, count > 0 ? count : ids.size() - first);
}

Batch random_batch(const ModelDescription& d, std::uint64_t seed) {
  std::vector<ModelInput> inputs;
  std::vector<Ids> targets;
  for (std::uint64_t b = 0; b < 2; ++b) {
    const Ids ids = random_ids(d, seed + b);
    inputs.push_back(window(d, ids));
    targets.emplace_back(ids.begin() + kBefore * d.shape.tokens_per_frame(), ids.end());
    targets.back().push_back(-1);
    targets.back()[2] = -1;
  }
  return stack(inputs, targets);
}

// The definition once more, for one window: vectors of doubles, nothing batched.
class Reference : public PlainTransformer {
 public:
  Reference(const ModelDescription& d, const TensorMap& weights)
      : PlainTransformer(weights), d_(d) {}

  // Logits (V) of the next token of a window with these positions (prefix of one token).
  // The last frame's joints come in `order`.
  at::Tensor next(const ModelInput& in, std::size_t positions,
                  const std::vector<std::size_t>& order = {0, 1}) const {
    const auto per_frame = static_cast<std::size_t>(d_.shape.tokens_per_frame());
    const std::size_t frame = (positions - 1) / per_frame, channel = (positions - 1) % per_frame;
    std::vector<at::Tensor> x = {row("token_embedding", in.token[0]) +
                                 row("position_embedding", 0)};
    for (std::size_t t = 0; t < frame; ++t)
      x.push_back(linear("frame_in", features(in, t)) +
                  row("position_embedding", static_cast<std::int64_t>(t) + 1));
    const at::Tensor states =
        norm("ln", blocks("block.", d_.config.n_layer, d_.config.n_head, at::stack(x)));
    const at::Tensor known = past(in, frame, states);
    std::vector<std::size_t> chosen(3, 0);  // positions of the tokens of the joint before
    std::vector<at::Tensor> y;
    std::size_t behind = 0;
    for (const std::size_t joint : order) {
      at::Tensor one = known[static_cast<std::int64_t>(joint)] +
                       row("joint.before_embedding", static_cast<std::int64_t>(behind));
      for (std::size_t k = 0; k < 3; ++k) one = one + chosen_rows("joint.", k, in, chosen[k]);
      y.push_back(one);
      if (joint == channel / 3) break;
      for (std::size_t k = 0; k < 3; ++k) chosen[k] = frame * per_frame + 3 * joint + k + 1;
      behind = joint + 1;
    }
    const at::Tensor state =
        blocks("joint.decoder.", d_.config.decoder_layer, d_.config.decoder_head, at::stack(y))[-1];
    const at::Tensor last = channel_state(in, frame, channel, state);
    at::Tensor logits = linear("head", last);
    const std::int64_t centre = in.centre[positions - 1];
    if (d_.config.output != "extrapolation" || centre == kNoCentre) return logits;
    const at::Tensor offsets = linear("offset_head", last);
    std::vector<at::Tensor> all;
    for (std::int64_t v = 0; v < d_.shape.vocabulary; ++v) {
      const std::int64_t bin = v - d_.shape.first_bin;
      at::Tensor logit = logits[v];
      if (bin >= 0 && bin < d_.shape.bins)
        logit =
            logit +
            offsets[std::clamp(bin - centre, -d_.config.reach, d_.config.reach) + d_.config.reach];
      all.push_back(logit);
    }
    return at::stack(all);
  }

 private:
  // What the token at this position, chosen for a joint's k-th channel, adds to what comes after
  // it; position 0: none.
  at::Tensor chosen_rows(const std::string& name, std::size_t k, const ModelInput& in,
                         std::size_t position) const {
    const auto which = static_cast<std::int64_t>(k);
    const bool known = position > 0 && in.token[position] != kHidden;
    const at::Tensor token =
        row(name + "chosen_embedding",
            known ? 1 + which * d_.shape.bins + in.token[position] - d_.shape.first_bin : 0);
    if (!d_.config.history) return token;
    return token + row(name + "surprise_embedding",
                       known ? 1 + which * (2 * d_.config.reach + 2) + in.surprise[position] : 0);
  }

  // The last layer: from a joint's state to the state that decides one of its channels.
  at::Tensor channel_state(const ModelInput& in, std::size_t frame, std::size_t channel,
                           const at::Tensor& joint) const {
    const auto per_frame = static_cast<std::size_t>(d_.shape.tokens_per_frame());
    const auto c = static_cast<std::int64_t>(channel);
    at::Tensor x = linear("channel.in", joint).view({3, d_.config.decoder_embd})[c % 3] +
                   linear("channel.own_in",
                          features_before(in, frame).view({d_.shape.channels, kFrameFeatures})[c]) +
                   row("channel.embedding", c);
    const std::size_t p = frame * per_frame + channel;  // the position before this channel
    if (d_.config.history)
      x = x + row("channel.velocity_embedding", in.velocity[p]) +
          row("channel.last_surprise_embedding", in.last_surprise[p]);
    for (std::size_t k = 0; k < 2; ++k)
      x = x + chosen_rows("channel.", k, in, k < channel % 3 ? p - channel % 3 + k + 1 : 0);
    const at::Tensor up = linear("channel.up", norm("channel.ln1", x));
    return norm("channel.ln2", x + linear("channel.down", gelu(up)));
  }

  at::Tensor features_before(const ModelInput& in, std::size_t frame) const {
    return frame > 0 ? features(in, frame - 1)
                     : at::zeros({d_.shape.channels * kFrameFeatures}, at::kDouble);
  }

  // What is known of each joint before the last of these frames, (J, width): one joint after the
  // other through the memory.
  at::Tensor past(const ModelInput& in, std::size_t frame, const at::Tensor& states) const {
    const std::int64_t joints = d_.shape.channels / 3;
    std::vector<at::Tensor> known;
    for (std::int64_t j = 0; j < joints; ++j) {
      std::vector<at::Tensor> x;
      for (std::size_t t = 0; t <= frame; ++t) {
        const at::Tensor before = features_before(in, t);
        const auto f = static_cast<std::int64_t>(t);
        x.push_back(linear("joint_in", at::cat({states[f], before}))
                        .view({joints, d_.config.decoder_embd})[j] +
                    linear("joint.own_in", before.view({joints, 3 * kFrameFeatures})[j]) +
                    row("joint.embedding", j) + row("joint.time_embedding", f));
      }
      known.push_back(blocks("joint.memory.", d_.config.memory_layer, d_.config.decoder_head,
                             at::stack(x))[-1]);
    }
    return at::stack(known);
  }
  at::Tensor features(const ModelInput& in, std::size_t frame) const {
    const auto per_frame = static_cast<std::size_t>(d_.shape.tokens_per_frame());
    const auto bin = [&](std::size_t t, std::int64_t c) {
      return static_cast<double>(in.token[1 + t * per_frame + static_cast<std::size_t>(c)] -
                                 d_.shape.first_bin);
    };
    std::vector<double> values;
    for (std::int64_t c = 0; c < d_.shape.channels; ++c) {
      if (bin(frame, c) < 0) {  // hidden
        values.insert(values.end(), kFrameFeatures, 0);
        continue;
      }
      const double u = (2 * bin(frame, c) + 1) / static_cast<double>(d_.shape.bins) - 1;
      values.push_back(u);
      for (const int k : {1, 2, 4}) {
        values.push_back(std::sin(k * kPi * u));
        values.push_back(std::cos(k * kPi * u));
      }
      const auto turn = [&](std::size_t back) {
        return frame < back + 2
                   ? 0
                   : bin(frame - back, c) - 2 * bin(frame - back - 1, c) + bin(frame - back - 2, c);
      };
      values.push_back(frame < 1 ? 0 : std::asinh(bin(frame, c) - bin(frame - 1, c)) / 2);
      values.push_back(std::asinh(turn(0)) / 2);
      values.push_back(std::asinh(turn(1)) / 2);
      for (std::size_t lag = 0; lag < 6; ++lag)
        values.push_back(std::min(std::max(turn(lag), -8.), 8.) / 4);
    }
    return at::tensor(values, at::kDouble);
  }
  ModelDescription d_;
};

TEST(FrameTransformer, AgreesWithItsDefinitionAtEveryPosition) {
  for (const ModelDescription& d : variants()) {
    const auto model = random_model(d, 1);
    const Reference reference(d, random_weights(d, 1));
    const ModelInput input = window(d, random_ids(d, 2));
    const at::Tensor logits = logits_of(*model, stack({input}))[0];
    ASSERT_EQ(logits.size(0), static_cast<std::int64_t>(input.size()));
    for (std::size_t p = 1; p <= input.size(); ++p) {
      if ((p - 1) % 7 == 6) continue;  // the separator comes next
      EXPECT_LT(
          largest_difference(logits[static_cast<std::int64_t>(p) - 1], reference.next(input, p)),
          1e-4)
          << variant_name(d) << ", position " << p;
    }
  }
}

TEST(FrameTransformer, AgreesWithItsDefinitionInAnotherOrder) {
  const ModelDescription d = small_frames_description();
  const auto model = std::dynamic_pointer_cast<FrameTransformer>(random_model(d, 1));
  const Reference reference(d, random_weights(d, 1));
  model->set_order({1, 0});
  const ModelInput input = window(d, random_ids(d, 2));
  const at::Tensor logits = logits_of(*model, stack({input}))[0];
  for (std::size_t p = 1; p < input.size() - 7; ++p) {
    if ((p - 1) % 7 == 6) continue;
    EXPECT_LT(largest_difference(logits[static_cast<std::int64_t>(p) - 1],
                                 reference.next(input, p, {1, 0})),
              1e-4)
        << p;
  }
}

// What the augmentation joint_subset shows of a window.
TEST(FrameTransformer, HiddenJointsAreSeenByNoOther) {
  for (const ModelDescription& d : variants()) {
    const auto model = random_model(d, 1);
    const Reference reference(d, random_weights(d, 1));
    Ids ids = random_ids(d, 2);
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (i % 7 < 3) ids[i] = kHidden;
    const ModelInput input = window(d, ids);
    const at::Tensor logits = logits_of(*model, stack({input}))[0];
    EXPECT_TRUE(at::isfinite(logits).all().item<bool>());
    for (std::size_t p = 1; p <= input.size(); ++p) {
      if ((p - 1) % 7 < 3 || (p - 1) % 7 == 6) continue;  // asked for nothing
      EXPECT_LT(
          largest_difference(logits[static_cast<std::int64_t>(p) - 1], reference.next(input, p)),
          1e-4)
          << variant_name(d) << ", position " << p;
    }
  }
}

TEST(FrameTransformer, OrdersDrawnInTrainingGiveTheLossOfThatOrder) {
  ModelDescription d = small_frames_description();
  d.config.shown_first = 1;
  const auto model = std::dynamic_pointer_cast<FrameTransformer>(random_model(d, 3));
  Random random(4);
  const Ids ids = random_stream(d.shape, 6, random);
  const ModelInput input = window_input(d, {2}, ids, 0, ids.size());
  Ids target = ids;
  target.push_back(-1);
  const Batch batch = stack({input}, {target});
  const at::NoGradGuard no_grad;
  const auto total = [&] { return model->loss(model->hidden(batch), batch).sum().item<double>(); };
  const double kept = total();
  model->set_order({1, 0});
  const double turned = total();
  ASSERT_GT(std::abs(kept - turned), 1e-2);
  model->train();
  int first = 0, second = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    at::manual_seed(seed);
    const double drawn = total();
    first += std::abs(drawn - kept) < 1e-3;
    second += std::abs(drawn - turned) < 1e-3;
  }
  // The second joint alone is first with probability (integral of p (1 - p)) = 1/6.
  EXPECT_EQ(first + second, 100);
  EXPECT_GT(second, 6);
  EXPECT_LT(second, 30);
}

TEST(FrameTransformer, TheSeparatorIsCertainAndCostsNothing) {
  const ModelDescription d = small_frames_description();
  const auto model = random_model(d, 1);
  const Batch batch = random_batch(d, 2);
  const at::Tensor logs = at::log_softmax(logits_of(*model, batch), -1);
  const at::NoGradGuard no_grad;
  const at::Tensor loss = model->loss(model->hidden(batch), batch);
  for (std::int64_t p = 6; p < batch.token.size(1); p += 7) {
    EXPECT_EQ(logs[0][p][3].item<float>(), 0) << p;
    EXPECT_EQ(loss[0][p].item<float>(), 0) << p;
  }
}

TEST(FrameTransformer, TheLossIsTheCrossEntropyOfTheLogits) {
  for (const ModelDescription& d : variants()) {
    const auto model = random_model(d, 3);
    const Batch batch = random_batch(d, 4);
    const at::Tensor expected = plain_loss(logits_of(*model, batch), batch.target);
    const at::NoGradGuard no_grad;
    EXPECT_LT(largest_difference(model->loss(model->hidden(batch), batch), expected), 1e-4);
  }
}

TEST(FrameTransformer, GradientsOfEveryParameterAgreeWithTheDefinition) {
  for (const ModelDescription& d : variants()) {
    const auto model = random_model(d, 5);
    const Reference reference(d, random_weights(d, 5));
    const Ids ids = random_ids(d, 6);
    const ModelInput input = window(d, ids);
    Ids target(input.token.begin() + 1, input.token.end());
    target.push_back(-1);
    const Batch batch = stack({input}, {target});
    model->loss(model->hidden(batch), batch).sum().backward();
    at::Tensor total = at::zeros({}, at::kDouble);
    for (std::size_t p = 1; p < input.size(); ++p)
      if ((p - 1) % 7 != 6)
        total = total - at::log_softmax(reference.next(input, p), -1)[input.token[p]];
    total.backward();
    expect_same_gradients(*model, reference, 2e-4, variant_name(d));
  }
}

TEST(FrameTransformer, ATokenNeverChangesWhatComesBeforeIt) {
  for (const ModelDescription& d : variants()) {
    const auto model = random_model(d, 7);
    const Ids ids = random_ids(d, 8);
    const at::Tensor before = logits_of(*model, stack({window(d, ids)}));
    for (std::size_t at = 0; at + 1 < window(d, ids).size(); ++at) {
      if (at % 7 == 6) continue;  // a separator is always one
      Ids changed = ids;
      std::int32_t& id = changed[at + static_cast<std::size_t>(kBefore) * 7];
      id = id == 5 ? 9 : 5;
      const at::Tensor after = logits_of(*model, stack({window(d, changed)}));
      const auto position = static_cast<std::int64_t>(at) + 1;
      EXPECT_LT(largest_difference(after.narrow(1, 0, position), before.narrow(1, 0, position)),
                1e-6)
          << variant_name(d) << ", token " << at;
      const std::int64_t next = at % 7 == 5 ? position + 1 : position;  // behind the separator
      if (next < before.size(1)) {
        EXPECT_GT(largest_difference(after.select(1, next), before.select(1, next)), 1e-5)
            << variant_name(d) << ", token " << at;
      }
    }
  }
}

TEST(FrameTransformer, AnUnfinishedFrameIsReadAsFarAsItGoes) {
  const ModelDescription d = small_frames_description();
  const auto model = random_model(d, 9);
  const Ids ids = random_ids(d, 10);
  const at::Tensor whole = logits_of(*model, stack({window(d, ids)}))[0];
  for (std::size_t count = 1; count <= 21; ++count) {
    const at::Tensor part = logits_of(*model, stack({window(d, ids, count)}))[0];
    ASSERT_EQ(part.size(0), static_cast<std::int64_t>(count) + 1);
    EXPECT_LT(largest_difference(part, whole.slice(0, 0, part.size(0))), 1e-5) << count;
  }
}

TEST(FrameTransformer, FreeTokensSeeEveryFrameAndAreSeenByNone) {
  const ModelDescription d = small_frames_description();
  const auto model = random_model(d, 11);
  const at::NoGradGuard no_grad;
  Ids ids = random_ids(d, 12);
  const Batch batch = stack({window(d, ids, 49)});  // 7 frames
  at::manual_seed(13);
  const at::Tensor extra = at::randn({1, 1, d.config.n_embd});
  const at::Tensor with = model->hidden(batch, extra);
  ASSERT_EQ(with.size(1), 1 + 7 + 1);
  EXPECT_LT(largest_difference(with.slice(1, 0, 8), model->hidden(batch)), 1e-6);
  for (std::size_t frame = 0; frame < 7; ++frame) {
    Ids changed = ids;
    std::int32_t& id = changed[(static_cast<std::size_t>(kBefore) + frame) * 7 + 1];
    id = id == 5 ? 9 : 5;
    const at::Tensor after = model->hidden(stack({window(d, changed, 49)}), extra);
    EXPECT_GT(largest_difference(after[0][8], with[0][8]), 1e-5) << frame;
  }
}

TEST(FrameTransformer, Bf16IsCloseToF32) {
  ModelDescription d = small_frames_description();
  d.config.decoder_embd = 16;  // a width that the kernels take
  const auto model = random_model(d, 14);
  const Batch batch = random_batch(d, 15);
  const auto mean_loss = [&] {
    const at::NoGradGuard no_grad;
    return model->loss(model->hidden(batch), batch).mean().item<double>();
  };
  const double exact = mean_loss();
  model->set_precision(at::kBFloat16);
  EXPECT_NEAR(mean_loss(), exact, 0.02 * exact);
  model->loss(model->hidden(batch), batch).sum().backward();
  for (const at::Tensor& parameter : model->parameters())
    EXPECT_TRUE(at::isfinite(parameter.grad()).all().item<bool>());
}

TEST(FrameTransformer, ItsParametersAreAsManyAsTheConfigSays) {
  for (const ModelDescription& d : variants()) {
    double count = 0;
    for (const at::Tensor& parameter : make_language_model(d)->parameters())
      count += static_cast<double>(parameter.numel());
    EXPECT_EQ(count, parameter_count(d)) << variant_name(d);
  }
}

}  // namespace

}  // namespace mocaplm::frame_transformer_test
