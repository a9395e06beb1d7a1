// A model's config: what may be said, what is refused, and the sizes that follow.
#include "model/config.h"

#include <gtest/gtest.h>

#include "support/refusal.h"
#include "support/small_models.h"

namespace mocaplm::config_test {

namespace {

ModelDescription full_description() {
  ModelDescription d = small_description("absolute", "absolute", false);
  d.config.dropout = 0.25;
  d.conditions = {"style", "content"};
  d.classes = {{"genre", {"break", "pop"}}};
  d.procedural = true;
  d.training = {{"data", "somewhere"}};
  return d;
}

std::string refused(const Json& json) {
  return refusal<DataError>([&] { model_from_json(json, "m/config.json"); });
}

TEST(ModelConfig, ComesBackFromJsonAsItWas) {
  for (const ModelDescription& d : {full_description(), small_description()}) {
    const ModelDescription back = model_from_json(to_json(d), "config.json");
    EXPECT_EQ(to_json(back).dump(), to_json(d).dump());
    EXPECT_EQ(back.config.position, d.config.position);
    EXPECT_EQ(back.config.dropout, d.config.dropout);
    EXPECT_EQ(back.shape.vocabulary, d.shape.vocabulary);
    EXPECT_EQ(back.conditions, d.conditions);
    EXPECT_EQ(back.classes, d.classes);
    EXPECT_EQ(back.procedural, d.procedural);
    EXPECT_EQ(back.tokenizer_fingerprint, d.tokenizer_fingerprint);
  }
}

TEST(ModelConfig, MissingAndUnknownKeysAreNamed) {
  const Json good = to_json(full_description());
  for (const auto& item : good.items()) {
    Json without = good;
    without.erase(item.key());
    const std::string message = refused(without);
    EXPECT_TRUE(contains(message, "m/config.json")) << message;
    EXPECT_TRUE(contains(message, item.key())) << message;
  }
  Json more = good;
  more["model"]["n_layers"] = 3;
  EXPECT_TRUE(contains(refused(more), "did you mean \"n_layer\"")) << refused(more);
}

TEST(ModelConfig, ImpossibleValuesAreRefused) {
  const Json good = to_json(full_description());
  const std::vector<std::pair<std::string, Json>> cases = {
      {"/model/n_layer", 0},
      {"/model/n_layer", 97},
      {"/model/n_embd", 1e9},
      {"/model/n_head", 3},
      {"/model/dropout", 1.0},
      {"/model/position", "relative"},
      {"/model/history", 1},
      {"/model/n_layer", 2.5},
      {"/model/block_size", 15},
      {"/stream/bins", 1},
      {"/stream/channels", 0},
      {"/stream/vocabulary", 14},
      {"/stream/vocabulary", 1e300},
      {"/stream/first_bin", -1},
      {"/conditions", "style"},
      {"/classes", nullptr},
      {"/classes", 3},
      {"/classes", Json::object()},
      {"/classes/0", 3},
      {"/classes/0/values", "a"},
      {"/procedural", 0},
      {"/format", 2},
      {"/model", Json::array()},
      {"/tokenizer_fingerprint", 5},
  };
  for (const auto& [place, value] : cases) {
    Json bad = good;
    bad[Json::json_pointer(place)] = value;
    EXPECT_TRUE(contains(refused(bad), "m/config.json")) << place << " = " << value;
  }
}

TEST(ModelConfig, ContradictionsAreUsageErrors) {
  ModelDescription d = small_description();
  EXPECT_NO_THROW(check_model(d));
  d.config.n_head = 3;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { check_model(d); }), "n_head (3) must divide"));
  d = small_description();
  d.shape.channels = 12;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { check_model(d); }), "block_size 24 is too small"));
}

TEST(ModelConfig, SizesFollowFromTheStream) {
  const ModelSizes sizes = model_sizes(small_description());
  EXPECT_GE(sizes.frame_positions, 24 / 4 + 2);  // the prefix, whole frames, an unfinished one
  EXPECT_EQ(sizes.channel_positions, 5);
  EXPECT_EQ(sizes.history_rows, 12);
  EXPECT_EQ(sizes.offsets, 11);
}

TEST(ModelConfig, ParameterCountIsThatOfTheTensors) {
  for (const ModelDescription& d : all_variants()) {
    std::int64_t count = 0;
    for (const auto& [name, tensor] : random_weights(d, 1)) count += tensor.size();
    EXPECT_EQ(parameter_count(d), static_cast<double>(count)) << variant_name(d);
  }
}

TEST(ModelConfig, TheThesisModelHasAboutTwentySixMillionParameters) {
  Json json = load_json(MOCAPLM_SOURCE_DIR "/configs/thesis.json");
  ModelDescription d;
  JsonObject model(json.at("model"), "thesis.json");
  read_settings(d.config, model);
  d.shape = {4 + 360, 4, 360, 42};
  const double count = parameter_count(d);
  std::printf("configs/thesis.json: %.2f million parameters\n", count / 1e6);
  EXPECT_NEAR(count / 1e6, 26, 0.5);
}

TEST(ModelConfig, JsonOfNothingButBracketsIsRefused) {
  const std::string deep(3000000, '[');
  EXPECT_THROW(parse_json(deep, "x"), DataError);
  EXPECT_THROW(parse_json("{\"a\":" + deep + std::string(deep.size(), ']') + "}", "x"), DataError);
  EXPECT_NO_THROW(parse_json("[\"" + deep + "\\\"" + deep + "\"]", "x"));
}

}  // namespace

}  // namespace mocaplm::config_test
