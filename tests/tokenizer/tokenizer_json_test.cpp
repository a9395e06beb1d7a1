#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "common/error.h"
#include "tests/tokenizer/random_clips.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm::tokenizer_json_test {
namespace {

Tokenizer example(const std::string& root = "steps") {
  TokenizerConfig config;
  config.root = root;
  return Tokenizer::fit(config, {random_clip(1, 100)});
}

std::string error_of(const Json& json) {
  try {
    Tokenizer::from_json(json, "t.json");
  } catch (const DataError& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(TokenizerJson, GoesThereAndBackExactly) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "mocaplm_tokenizer_json_test.json";
  for (const std::string root : {"steps", "absolute", "none"}) {
    Tokenizer tokenizer = example(root);
    tokenizer.add_label_values("genre", {"waack", "krump"});
    tokenizer.add_label_values("dancer", {"d26"});
    tokenizer.save(file);
    const Tokenizer back = Tokenizer::load(file);
    EXPECT_EQ(back.to_json().dump(), tokenizer.to_json().dump());
    EXPECT_EQ(back.fingerprint(), tokenizer.fingerprint());
    EXPECT_EQ(back.label_id("dancer", "d26"), tokenizer.label_id("dancer", "d26"));
    const Clip clip = random_clip(2, 60);
    EXPECT_EQ(back.encode(clip).ids, tokenizer.encode(clip).ids);
  }
  std::filesystem::remove(file);
}

TEST(TokenizerJson, FingerprintChangesWithTheBinsMeaningAndNotWithLabels) {
  Tokenizer tokenizer = example();
  const std::string print = tokenizer.fingerprint();
  tokenizer.add_label_values("genre", {"waack"});
  EXPECT_EQ(tokenizer.fingerprint(), print);
  EXPECT_NE(example("absolute").fingerprint(), print);
  TokenizerConfig config;
  for (const auto& change :
       std::vector<std::function<void()>>{[&] { config.bins = 180; }, [&] { config.fps = 30; },
                                          [&] { config.joints = {"left_arm"}; }}) {
    config = TokenizerConfig();
    change();
    EXPECT_NE(Tokenizer::fit(config, {random_clip(1, 100)}).fingerprint(), print);
  }
  EXPECT_NE(Tokenizer::fit(TokenizerConfig(), {random_clip(3, 100)}).fingerprint(), print);
}

TEST(TokenizerJson, RefusesFilesThatAreNotWhole) {
  const Json good = example().to_json();
  ASSERT_EQ(error_of(good), "(no error)");
  for (const auto& item : good.items()) {
    Json bad = good;
    bad.erase(item.key());
    EXPECT_NE(error_of(bad).find("\"" + item.key() + "\": missing"), std::string::npos)
        << error_of(bad);
  }
  for (const auto& item : good["settings"].items()) {
    Json bad = good;
    bad["settings"].erase(item.key());
    EXPECT_NE(error_of(bad).find(item.key()), std::string::npos);
  }
  const auto changed = [&](const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    return error_of(bad);
  };
  const auto says = [&](const std::string& part, const std::function<void(Json&)>& change) {
    EXPECT_NE(changed(change).find(part), std::string::npos) << changed(change);
  };
  says("unknown key", [](Json& j) { j["extra"] = 1; });
  says("unknown key", [](Json& j) { j["settings"]["extra"] = 1; });
  says("unknown key", [](Json& j) { j["root_ranges"]["x"] = {0, 1}; });
  says("version", [](Json& j) { j["version"] = 2; });
  says("format", [](Json& j) { j["format"] = "other"; });
  says("left_kneee", [](Json& j) { j["settings"]["joints"] = {"left_kneee"}; });
  says("low below high", [](Json& j) { j["root_ranges"]["left"] = {1, -1}; });
  says("low below high", [](Json& j) { j["root_ranges"]["left"] = {1, 2, 3}; });
  says("left", [](Json& j) { j["root_ranges"]["left"] = {0, "a"}; });
  says("low below high", [](Json& j) { j["root_ranges"]["left"] = {0, 1e300}; });
  says("changed by hand", [](Json& j) { j["root_ranges"]["left"] = {-1, 1}; });
  says("changed by hand", [](Json& j) { j["settings"]["bins"] = 361; });
  says("bins", [](Json& j) { j["settings"]["bins"] = 1; });
  says("bins", [](Json& j) { j["settings"]["bins"] = 4e9; });
  says("labels", [](Json& j) { j["labels"] = 3; });
  says("twice", [](Json& j) { j["labels"] = {{{"label", "a"}, {"values", {"x", "x"}}}}; });
  says("at least one value", [](Json& j) {
    j["labels"] = {{{"label", "a"}, {"values", Json::array()}}};
  });
}

}  // namespace
}  // namespace mocaplm::tokenizer_json_test
