// The settings files in configs/ load, and what a settings file must not say is refused by name.
#include "train/config.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "common/error.h"

namespace fs = std::filesystem;

namespace mocaplm::config_test {

namespace {

std::vector<fs::path> config_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(MOCAPLM_SOURCE_DIR "/configs"))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// The message of the DataError that `text` gives, "" when there is none.
std::string refusal(const std::string& text) {
  try {
    run_config_from_json(parse_json(text, "run.json"), "run.json");
    return "";
  } catch (const DataError& error) {
    return error.what();
  }
}

std::string section(const std::string& name, const std::string& key, const std::string& value) {
  return "{\"" + name + "\": {\"" + key + "\": " + value + "}}";
}

// One setting of a section with its type and, for numbers, its range.
struct Setting {
  std::string section, key, type;
  double min = 0, max = 0;
};

class ListSettings {
 public:
  ListSettings(std::string section, std::vector<Setting>& all)
      : section_(std::move(section)), all_(all) {}
  void integer(const char* key, std::int64_t&, std::int64_t min, std::int64_t max, const char*) {
    all_.push_back({section_, key, "integer", static_cast<double>(min), static_cast<double>(max)});
  }
  void number(const char* key, double&, double min, double max, const char*) {
    all_.push_back({section_, key, "number", min, max});
  }
  void boolean(const char* key, bool&, const char*) { all_.push_back({section_, key, "boolean"}); }
  void choice(const char* key, std::string&, const std::vector<std::string>&, const char*) {
    all_.push_back({section_, key, "choice"});
  }
  void text(const char* key, std::string&, const char*) { all_.push_back({section_, key, "text"}); }
  void texts(const char* key, std::vector<std::string>&, const char*) {
    all_.push_back({section_, key, "texts"});
  }

 private:
  std::string section_;
  std::vector<Setting>& all_;
};

std::vector<Setting> all_settings() {
  std::vector<Setting> all;
  RunConfig config;
  ListSettings tokenizer("tokenizer", all), model("model", all), train("train", all);
  config.tokenizer.describe(tokenizer);
  config.model.describe(model);
  config.train.describe(train);
  return all;
}

// Values of a wrong type, out of range or not finite.
std::vector<std::string> wrong_values(const Setting& setting) {
  std::vector<std::string> wrong = {"null", "{}"};
  const bool numeric = setting.type == "integer" || setting.type == "number";
  if (setting.type != "texts") wrong.push_back("[1]");
  if (setting.type != "boolean") wrong.push_back("true");
  if (setting.type == "texts") wrong.insert(wrong.end(), {"\"pelvis\"", "[1]", "7"});
  if (setting.type == "choice") wrong.insert(wrong.end(), {"\"no such choice\"", "\"\"", "7"});
  if (setting.type == "boolean") wrong.insert(wrong.end(), {"1", "\"true\""});
  if (numeric) wrong.insert(wrong.end(), {"\"3\"", "-1e300", "1e300", "18446744073709551615"});
  if (setting.type == "integer") wrong.insert(wrong.end(), {"1.5", "1e2"});
  if (numeric) {
    wrong.push_back(Json(setting.min - 1).dump());
    wrong.push_back(Json(setting.max + 1).dump());
  }
  return wrong;
}

}  // namespace

TEST(RunConfig, EveryFileInConfigsLoads) {
  const std::vector<fs::path> files = config_files();
  EXPECT_FALSE(files.empty());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    RunConfig config;
    ASSERT_NO_THROW(config = load_run_config(file));
    EXPECT_EQ(config.model.n_embd % config.model.n_head, 0);
    EXPECT_LE(config.train.micro_batch, config.train.batch_size);
    EXPECT_LE(config.train.warmup, config.train.steps);
  }
}

TEST(RunConfig, ThesisHasItsTwentySixMillionParameters) {
  const ModelConfig model = load_run_config(MOCAPLM_SOURCE_DIR "/configs/thesis.json").model;
  const auto width = static_cast<double>(model.n_embd);
  // Blocks (four matrices of attention, eight of the wide layer) and the embedding and head of 364
  // ids.
  const double parameters =
      static_cast<double>(model.n_layer) * 12 * width * width + 2 * 364 * width;
  EXPECT_NEAR(parameters / 1e6, 26, 0.6);
  EXPECT_EQ(model.output, "absolute");
  EXPECT_EQ(model.block_size, 1024);
}

TEST(RunConfig, WritesWhatItReads) {
  const std::vector<fs::path> files = config_files();
  for (const fs::path& file : files) {
    const Json once = to_json(load_run_config(file));
    EXPECT_EQ(to_json(run_config_from_json(once, "again")), once) << file;
  }
  EXPECT_EQ(to_json(run_config_from_json(Json::object(), "empty")), to_json(RunConfig()));
}

TEST(RunConfig, KeysThatAreMissingKeepTheirDefaults) {
  const RunConfig config =
      run_config_from_json(parse_json(section("model", "n_layer", "7"), "run.json"), "run.json");
  EXPECT_EQ(config.model.n_layer, 7);
  EXPECT_EQ(config.model.n_embd, ModelConfig().n_embd);
  EXPECT_EQ(config.train.steps, TrainConfig().steps);
}

TEST(RunConfig, RefusesWrongValuesOfEverySettingByName) {
  for (const Setting& setting : all_settings())
    for (const std::string& value : wrong_values(setting)) {
      const std::string message = refusal(section(setting.section, setting.key, value));
      SCOPED_TRACE(setting.section + "." + setting.key + " = " + value);
      EXPECT_NE(message.find("\"" + setting.key + "\""), std::string::npos) << message;
      EXPECT_NE(message.find("run.json"), std::string::npos) << message;
      EXPECT_NE(message.find("expected"), std::string::npos) << message;
    }
}

TEST(RunConfig, RefusesUnknownKeysAndSectionsWithTheNearestKnownOne) {
  const std::string key = refusal(section("train", "learning_rat", "1e-3"));
  EXPECT_NE(key.find("\"learning_rat\""), std::string::npos) << key;
  EXPECT_NE(key.find("learning_rate"), std::string::npos) << key;
  const std::string part = refusal("{\"tran\": {}}");
  EXPECT_NE(part.find("\"tran\""), std::string::npos) << part;
  EXPECT_NE(part.find("train"), std::string::npos) << part;
  EXPECT_FALSE(refusal(section("tokenizer", "steps", "10")).empty()) << "a key of another section";
}

TEST(RunConfig, RefusesWhatIsNoObjectOrNoJson) {
  for (const char* text :
       {"[]", "3", "null", "\"run\"", "{\"model\": []}", "{\"train\": 3}", "{\"tokenizer\": null}",
        "", "{", "{\"model\": {\"dropout\": NaN}}", "{\"model\": {\"dropout\": 1e999}}"}) {
    SCOPED_TRACE(text);
    EXPECT_NE(refusal(text).find("run.json"), std::string::npos);
  }
}

TEST(RunConfig, NamesAFileThatIsNotThere) {
  try {
    load_run_config("/no/such/settings.json");
    FAIL() << "expected DataError";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/settings.json"), std::string::npos);
  }
}

}  // namespace mocaplm::config_test
