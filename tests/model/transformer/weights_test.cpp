// Weights between the trainable model and its directory: names, growth, the stored self-test.
#include "model/transformer/weights.h"

#include <gtest/gtest.h>

#include "model/transformer/transformer.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace mocaplm::weights_test {

namespace {

std::string refused(const ModelDescription& d, const TensorMap& tensors, bool may_grow = false) {
  Transformer model(d);
  return refusal<DataError>([&] { import_weights(model, tensors, "m.safetensors", may_grow); });
}

TEST(Weights, NamesShapesAndCountAreThoseOfTheFile) {
  for (const ModelDescription& d : all_variants()) {
    const Transformer model(d);
    const TensorMap exported = export_weights(model), expected = random_weights(d, 1);
    ASSERT_EQ(exported.size(), expected.size());
    double count = 0;
    for (const auto& [name, tensor] : expected) {
      ASSERT_EQ(exported.count(name), 1u) << name;
      EXPECT_EQ(exported.at(name).shape, tensor.shape) << name;
      count += static_cast<double>(exported.at(name).values.size());
    }
    EXPECT_EQ(count, parameter_count(d)) << variant_name(d);
  }
}

TEST(Weights, WhatIsImportedIsExported) {
  const ModelDescription d = small_description();
  const TensorMap tensors = random_weights(d, 2);
  Transformer model(d);
  import_weights(model, tensors, "x");
  const TensorMap back = export_weights(model);
  for (const auto& [name, tensor] : tensors) EXPECT_EQ(back.at(name).values, tensor.values) << name;
}

TEST(Weights, MissingUnknownAndOddTensorsAreNamed) {
  const ModelDescription d = small_description();
  const TensorMap good = random_weights(d, 3);
  TensorMap bad = good;
  bad.erase("block.1.up.weight");
  EXPECT_TRUE(contains(refused(d, bad), "block.1.up.weight"));
  bad = good;
  bad["block.2.up.weight"] = good.at("block.1.up.weight");
  EXPECT_TRUE(contains(refused(d, bad), "block.2.up.weight"));
  bad = good;
  bad["head.weight"].shape = {16, 18};
  EXPECT_TRUE(contains(refused(d, bad), "(16, 18)"));
  EXPECT_TRUE(contains(refused(d, bad, true), "head.weight"));
  bad = good;
  bad["token_embedding"].shape = {17, 16};
  bad["token_embedding"].values.resize(17 * 16);
  EXPECT_TRUE(contains(refused(d, bad), "token_embedding"));
}

TEST(Weights, LabelTokensMayBeAddedAndOldRowsStay) {
  const ModelDescription old = small_description();
  ModelDescription grown = old;
  grown.shape.vocabulary += 5;
  const TensorMap tensors = random_weights(old, 4);
  EXPECT_TRUE(contains(refused(grown, tensors), "shape"));
  EXPECT_TRUE(contains(refused(old, random_weights(grown, 4), true), "shape"));  // never fewer
  at::manual_seed(5);
  Transformer model(grown);
  const TensorMap fresh = export_weights(model);
  import_weights(model, tensors, "x", true);
  const TensorMap now = export_weights(model);
  for (const auto& [name, tensor] : tensors) {
    const std::vector<float>& values = now.at(name).values;
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(values[i], i < tensor.values.size() ? tensor.values[i] : fresh.at(name).values[i])
          << name << " " << i;
  }
  EXPECT_EQ(now.at("token_embedding").shape[0], grown.shape.vocabulary);
  EXPECT_EQ(now.at("head.bias").shape[0], grown.shape.vocabulary);
}

StoredModel stored_model(const ModelDescription& d, std::uint64_t seed) {
  StoredModel stored;
  stored.description = d;
  stored.tensors = random_weights(d, seed);
  Transformer model(d);
  import_weights(model, stored.tensors, "x");
  Random random(seed);
  stored.self_test =
      make_self_test(model, {window_input(d, {2}, random_stream(d.shape, 5, random), 0, 20),
                             window_input(d, {2}, random_stream(d.shape, 5, random), 0, 14)});
  return stored;
}

TEST(SelfTest, PassesOnTheSameWeightsInEveryVariant) {
  for (const ModelDescription& d : all_variants())
    EXPECT_NO_THROW(load_transformer(stored_model(d, 6), "m")) << variant_name(d);
}

TEST(SelfTest, RefusesChangedWeightsAndInputs) {
  const ModelDescription d = small_description();
  const StoredModel good = stored_model(d, 7);
  StoredModel bad = good;
  for (const auto& [name, tensor] : good.tensors) {
    if (name.find("bias") != std::string::npos && name.find("ln") == std::string::npos) continue;
    for (float& value : bad.tensors[name].values) value = -value;
    const std::string message = refusal<DataError>([&] { load_transformer(bad, "m"); });
    EXPECT_TRUE(contains(message, "self-test fails")) << name << ": " << message;
    bad.tensors[name] = tensor;
  }
  bad.self_test[1].input.token[2] = 1000;
  EXPECT_TRUE(contains(refusal<DataError>([&] { load_transformer(bad, "m"); }), "token 1000"));
}

TEST(SelfTest, IsMadeInF32WithoutDropoutAndLeavesTheModelAsItWas) {
  ModelDescription d = small_description();
  const StoredModel stored = stored_model(d, 8);
  d.config.dropout = 0.5;
  Transformer model(d);
  import_weights(model, stored.tensors, "x");
  model.train();
  model.set_precision(at::kBFloat16);
  const auto again = make_self_test(model, {stored.self_test[0].input});
  EXPECT_NO_THROW(check_self_test(stored.self_test[0], again[0].logits, "m"));
  EXPECT_TRUE(model.is_training());
  EXPECT_EQ(model.precision(), at::kBFloat16);
}

}  // namespace

}  // namespace mocaplm::weights_test
