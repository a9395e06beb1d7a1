// A model directory: saved, loaded, damaged in every way, and never lost.
#include "model/directory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace fs = std::filesystem;

namespace mocaplm::directory_test {

namespace {

const std::vector<std::string> kFiles = {"config.json", "model.safetensors", "selftest.json",
                                         "tokenizer.json"};

StoredModel some_model(std::uint64_t seed) {
  Random random(seed);
  StoredModel model;
  model.description = small_description();
  model.description.conditions = {"style"};
  model.tensors = random_weights(model.description, seed);
  model.tokenizer = {{"a tokenizer", seed}};
  for (int i = 0; i < 2; ++i) {
    SelfTestCase one;
    one.input = window_input(model.description, {2, 1},
                             random_stream(model.description.shape, 5, random), 0, 20);
    for (std::int64_t v = 0; v < model.description.shape.vocabulary; ++v)
      one.logits.push_back(static_cast<float>(random.normal()));
    model.self_test.push_back(one);
  }
  return model;
}

void expect_same(const StoredModel& a, const StoredModel& b) {
  EXPECT_EQ(to_json(a.description).dump(), to_json(b.description).dump());
  EXPECT_EQ(a.tokenizer.dump(), b.tokenizer.dump());
  ASSERT_EQ(a.tensors.size(), b.tensors.size());
  for (const auto& [name, tensor] : a.tensors) {
    EXPECT_EQ(tensor.shape, b.tensors.at(name).shape) << name;
    EXPECT_EQ(tensor.values, b.tensors.at(name).values) << name;
  }
  ASSERT_EQ(a.self_test.size(), b.self_test.size());
  for (std::size_t i = 0; i < a.self_test.size(); ++i) {
    const ModelInput &x = a.self_test[i].input, &y = b.self_test[i].input;
    EXPECT_EQ(a.self_test[i].logits, b.self_test[i].logits);
    for (auto list :
         {&ModelInput::token, &ModelInput::frame, &ModelInput::channel, &ModelInput::centre,
          &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
      EXPECT_EQ(x.*list, y.*list);
  }
}

// Writes the marker anew, as somebody would who changes a model on purpose.
void sign(const fs::path& directory) {
  Json marker = Json::object();
  for (const std::string& name : kFiles) {
    const std::string bytes = read_file(directory / name);
    marker[name] = {{"bytes", bytes.size()}, {"hash", hex(stable_hash(bytes))}};
  }
  put((directory / "complete").string(), marker.dump());
}

class ModelDirectory : public testing::Test {
 protected:
  void SetUp() override { save_model(path_, model_); }
  std::string refused() {
    return refusal<DataError>([&] { load_model(path_); });
  }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "model";
  StoredModel model_ = some_model(1);
};

TEST_F(ModelDirectory, LoadsWhatWasSaved) {
  expect_same(load_model(path_), model_);
  EXPECT_EQ(to_json(load_description(path_)).dump(), to_json(model_.description).dump());
  save_model(path_, some_model(2));
  expect_same(load_model(path_), some_model(2));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "leftovers";
}

TEST_F(ModelDirectory, EveryDamagedFileIsNamed) {
  for (std::string name : kFiles) {
    const std::string bytes = read_file(path_ / name);
    for (const std::size_t size : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
      put(file(name), bytes.substr(0, size));
      EXPECT_TRUE(contains(refused(), name)) << size;
    }
    for (const std::size_t at : {std::size_t{0}, bytes.size() / 3, bytes.size() - 1}) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ 1);
      put(file(name), changed);
      EXPECT_TRUE(contains(refused(), name)) << at;
    }
    fs::remove(path_ / name);
    if (name != "config.json")  // without it the folder is no model at all
      EXPECT_TRUE(contains(refused(), name));
    else
      EXPECT_TRUE(contains(refused(), "holds no config.json"));
    put(file(name), bytes);
  }
  expect_same(load_model(path_), model_);
}

TEST_F(ModelDirectory, WithoutAWholeMarkerItIsNotLoaded) {
  const std::string marker = read_file(path_ / "complete");
  fs::remove(path_ / "complete");
  EXPECT_TRUE(contains(refused(), "\"complete\""));
  for (std::size_t size = 0; size + 3 < marker.size(); size += 7) {
    put(file("complete"), marker.substr(0, size));
    EXPECT_TRUE(contains(refused(), "complete")) << size;
  }
  put(file("complete"), "{}");
  EXPECT_TRUE(contains(refused(), "does not list config.json"));
  put(file("complete"), "[]");
  refused();
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    std::string damaged = marker;
    damaged[random.below(marker.size())] = static_cast<char>(random.below(256));
    put(file("complete"), damaged);
    if (reads_or_refuses([&] { load_model(path_); }, "model"))
      expect_same(load_model(path_), model_);
  }
}

TEST_F(ModelDirectory, DamageBehindAGoodHashIsReadOrRefused) {
  Random random(6);
  int refusals = 0;
  for (int round = 0; round < 600; ++round) {
    const std::string name = kFiles[static_cast<std::size_t>(round) % kFiles.size()];
    const std::string bytes = read_file(path_ / name);
    std::string damaged = bytes;
    const std::size_t range = name == "model.safetensors" ? 2500 : bytes.size();
    for (std::uint64_t i = 0; i < 1 + random.below(2); ++i)
      damaged[random.below(range)] = static_cast<char>(random.below(256));
    put(file(name), damaged);
    sign(path_);
    refusals += reads_or_refuses([&] { load_model(path_); }, name) ? 0 : 1;
    put(file(name), bytes);
  }
  EXPECT_GT(refusals, 100);
}

TEST_F(ModelDirectory, AConfigThatAsksForMoreThanTheWeightsIsRefused) {
  Json config = load_json(path_ / "config.json");
  config["model"]["n_layer"] = 96;
  config["model"]["n_embd"] = 8192;
  put(file("config.json"), config.dump());
  sign(path_);
  EXPECT_TRUE(contains(refused(), "config.json asks for"));
}

TEST_F(ModelDirectory, OddSelfTestsAreRefused) {
  const Json good = load_json(path_ / "selftest.json");
  const std::vector<std::pair<std::string, Json>> cases = {
      {"/0/token/0", 1e300}, {"/0/token/0", 0.5},    {"/0/token", Json::array()},
      {"/0/frame/0", "a"},   {"/0/logits", nullptr}, {"/0/more", 1},
      {"", Json::object()},  {"/0/centre/1", -3e9},  {"/1", 4},
  };
  for (const auto& [place, value] : cases) {
    Json bad = good;
    bad[Json::json_pointer(place)] = value;
    put(file("selftest.json"), bad.dump());
    sign(path_);
    EXPECT_TRUE(contains(refused(), "selftest.json")) << place;
  }
}

TEST_F(ModelDirectory, AFailedSaveLeavesTheOldModel) {
  EXPECT_THROW(save_model(path_, some_model(2),
                          [](const fs::path& directory) {
                            put((directory / "optimizer.safetensors").string(), "half");
                            throw DataError(in_file("optimizer.safetensors"), "the disk is full");
                          }),
               DataError);
  expect_same(load_model(path_), model_);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "leftovers";
}

TEST_F(ModelDirectory, MoreFilesAreMarkedToo) {
  save_model(path_, model_,
             [](const fs::path& directory) { put((directory / "state.json").string(), "{}"); });
  EXPECT_NO_THROW(load_model(path_));
  put(file("state.json"), "{ }");
  EXPECT_TRUE(contains(refused(), "state.json"));
}

TEST_F(ModelDirectory, OtherFoldersAreNotReplaced) {
  const fs::path other = folder_ / "photos";
  fs::create_directories(other);
  put((other / "dance.jpg").string(), "precious");
  EXPECT_THROW(save_model(other, model_), DataError);
  EXPECT_EQ(read_file(other / "dance.jpg"), "precious");
  EXPECT_THROW(save_model(other / "dance.jpg", model_), DataError);
  EXPECT_EQ(read_file(other / "dance.jpg"), "precious");
}

TEST_F(ModelDirectory, ATrainingRunStandsForItsBestModel) {
  const fs::path run = folder_ / "run";
  EXPECT_TRUE(contains(refusal<DataError>([&] { resolve_model(run); }), "no such model folder"));
  fs::create_directories(run);
  EXPECT_TRUE(contains(refusal<DataError>([&] { resolve_model(run); }), "config.json"));
  save_model(run / "last", some_model(3));
  EXPECT_EQ(resolve_model(run), run / "last");
  save_model(run / "best", some_model(4));
  EXPECT_EQ(resolve_model(run), run / "best");
  expect_same(load_model(run), some_model(4));
  EXPECT_EQ(resolve_model(path_), path_);
  EXPECT_THROW(resolve_model(path_ / "config.json"), DataError);
}

TEST_F(ModelDirectory, InputsOutsideTheTablesAreRefused) {
  const ModelDescription& d = model_.description;
  const ModelInput good = model_.self_test[0].input;
  EXPECT_NO_THROW(check_input(good, d, "x"));
  for (auto list : {&ModelInput::token, &ModelInput::frame, &ModelInput::channel,
                    &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    for (const std::int32_t value : {-1, 18, 1 << 30}) {
      ModelInput bad = good;
      (bad.*list)[7] = value;
      EXPECT_TRUE(contains(refusal<DataError>([&] { check_input(bad, d, "x"); }), "position 7"));
    }
  EXPECT_THROW(check_input(ModelInput(), d, "x"), DataError);
  ModelInput longer = good;
  while (longer.size() < 25) append_prefix(longer, d, 0, false, {}, 0);
  EXPECT_THROW(check_input(longer, d, "x"), DataError);
}

TEST_F(ModelDirectory, SelfTestsAllowRoundingOnly) {
  const SelfTestCase& one = model_.self_test[0];
  std::vector<float> logits = one.logits;
  EXPECT_NO_THROW(check_self_test(one, logits, "x"));
  logits[3] += 1e-4f;
  EXPECT_NO_THROW(check_self_test(one, logits, "x"));
  logits[3] += 0.2f;
  EXPECT_TRUE(contains(refusal<DataError>([&] { check_self_test(one, logits, "x"); }), "logit 3"));
  logits[3] = std::nanf("");
  EXPECT_THROW(check_self_test(one, logits, "x"), DataError);
  logits.pop_back();
  EXPECT_THROW(check_self_test(one, logits, "x"), DataError);
}

}  // namespace

}  // namespace mocaplm::directory_test
