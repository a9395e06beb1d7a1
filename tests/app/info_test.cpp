// info on models, runs and tokenizers; its other inputs are in data_commands_test.cpp.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "model/directory.h"
#include "support/small_models.h"
#include "tokenizer/tokenizer.h"

namespace fs = std::filesystem;

namespace mocaplm::info_test {
namespace {

class Info : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  TemporaryFolder folder_;
};

TEST_F(Info, TellsEverySettingOfAModelAndWhatItKnows) {
  ModelDescription model = small_description();
  model.conditions = {"genre"};
  model.classes = {{"dancer", {"d01", "d02"}}};
  model.procedural = true;
  StoredModel stored;
  stored.description = model;
  stored.tensors = random_weights(model, 1);
  stored.tokenizer = Json::object();
  save_model(folder_ / "run" / "best", stored);
  for (const char* path : {"run", "run/best", "run/best/config.json"}) {
    const Ran ran = run_mocaplm("info " + at(path) + " --json " + at("info.json"));
    ASSERT_EQ(ran.code, 0) << ran.text;
    const Json settings = settings_json(model.config);
    for (const auto& item : settings.items())
      if (item.key() != "architecture") {  // its value stands in the title
        EXPECT_NE(ran.text.find(item.key()), std::string::npos) << item.key() << "\n" << ran.text;
      }
    for (const char* part : {"made up", "genre", "classifies dancer", "d01, d02", "procedural"})
      EXPECT_NE(ran.text.find(part), std::string::npos) << part << "\n" << ran.text;
    EXPECT_EQ(load_json(folder_ / "info.json").size(), 1u);
  }
}

TEST_F(Info, TellsWhatATokenizerIs) {
  TokenizerConfig config;
  config.root = "none";
  Tokenizer tokenizer = Tokenizer::fit(config, {});
  tokenizer.add_label_values("genre", {"waack", "pop"});
  tokenizer.save(folder_ / "tokenizer.json");
  const Ran ran = run_mocaplm("info " + at("tokenizer.json"));
  ASSERT_EQ(ran.code, 0) << ran.text;
  for (const std::string& part :
       {std::string("360"), tokenizer.fingerprint(), std::string("waack")})
    EXPECT_NE(ran.text.find(part), std::string::npos) << part << "\n" << ran.text;
}

TEST_F(Info, RefusesConfigsThatNoModelHas) {
  const std::string sound = to_json(small_description()).dump();
  Random random(7);
  for (int i = 0; i < 40; ++i) {
    std::string text = sound;
    text[random.below(text.size())] = static_cast<char>(32 + random.below(95));
    write_file(folder_ / "m" / "config.json", text);
    const Ran ran = run_mocaplm("info " + at("m"));
    EXPECT_TRUE(ran.code == 0 || ran.code == 3) << ran.code << "\n" << text << "\n" << ran.text;
  }
  write_file(folder_ / "m" / "config.json", sound.substr(0, sound.size() / 2));
  EXPECT_EQ(run_mocaplm("info " + at("m")).code, 3);
}

}  // namespace
}  // namespace mocaplm::info_test
