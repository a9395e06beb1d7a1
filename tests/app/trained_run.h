// A tiny walk from the command line that several tests start from: procedural dances of two genres
// (data/), a config (config.json), a pre-trained run (run/) and a fine-tuned one (tuned/).
// Everything lies in one folder, so that a test can tell whether a command changed anything there.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/random.h"
#include "common/temporary_folder.h"

namespace mocaplm {

// File names below `folder` with what they hold.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    all[std::filesystem::relative(entry.path(), folder).string()] =
        entry.is_regular_file() ? read_file(entry.path()) : "";
  return all;
}

// Lists every file of a model anew in its marker, as if it had been saved like this.
inline void sign(const std::filesystem::path& model) {
  Json files = Json::object();
  for (const char* name : {"config.json", "model.safetensors", "selftest.json", "tokenizer.json"}) {
    const std::string bytes = read_file(model / name);
    files[name] = {{"bytes", bytes.size()}, {"hash", hex(stable_hash(bytes))}};
  }
  write_file(model / "complete", files.dump());
}

class TrainedRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    must("synth --out " + at("data") +
         " --genres WA,HO --dancers 1 --choreographies 2 --seconds 1.5");
    write_file(*folder_ / "config.json", config().dump());
    must("train --threads 1 --config " + at("config.json") + " --data " + at("data") + " --out " +
         at("run"));
    must("train --threads 1 --steps 2 --from " + at("run") + " --config " + at("config.json") +
         " --data " + at("data") + " --out " + at("tuned"));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Json config() {
    return {{"tokenizer", {{"bins", 30}, {"joints", {"pelvis", "right_shoulder"}}}},
            {"model", {{"n_layer", 1}, {"n_head", 2}, {"n_embd", 16}, {"block_size", 160}}},
            {"train",
             {{"steps", 4},
              {"batch_size", 2},
              {"micro_batch", 2},
              {"warmup", 1},
              {"validate_every", 2},
              {"validation_windows", 2},
              {"save_every", 2}}}};
  }

  // A path in the folder, as a shell takes it.
  static std::string at(const std::string& name) { return "'" + (*folder_ / name).string() + "'"; }
  static std::filesystem::path path(const std::string& name) { return *folder_ / name; }

  static std::string must(const std::string& arguments) {
    const Ran ran = run_mocaplm(arguments);
    EXPECT_EQ(ran.code, 0) << arguments << "\n" << ran.text;
    return ran.text;
  }

  // Expects exit code `code`, a last line that names `part`, and that no file was changed or made.
  static void refused(const std::string& arguments, int code, const std::string& part) {
    const auto before = contents(folder_->path());
    const Ran ran = run_mocaplm(arguments);
    EXPECT_EQ(ran.code, code) << arguments << "\n" << ran.text;
    const std::size_t message = ran.text.find("mocaplm: ");
    ASSERT_NE(message, std::string::npos) << arguments << "\n" << ran.text;
    EXPECT_NE(ran.text.find(part, message), std::string::npos) << arguments << "\n" << ran.text;
    const auto after = contents(folder_->path());
    for (const auto& [name, bytes] : before)
      EXPECT_TRUE(after.count(name) == 1 && after.at(name) == bytes)
          << arguments << " hurt " << name;
    for (const auto& item : after)
      EXPECT_EQ(before.count(item.first), 1u) << arguments << " left " << item.first;
  }

  // A copy of the folder `from` named "bad" that `damage` is done to.
  static void make_bad(const std::string& from,
                       const std::function<void(const std::filesystem::path&)>& damage) {
    std::filesystem::remove_all(path("bad"));
    std::filesystem::copy(path(from), path("bad"), std::filesystem::copy_options::recursive);
    damage(path("bad"));
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};

inline std::unique_ptr<TemporaryFolder> TrainedRun::folder_;

// Changes one value of a JSON file; `key` as "/model/n_head".
inline void edit_json(const std::filesystem::path& file, const std::string& key,
                      const Json& value) {
  Json json = load_json(file);
  json[Json::json_pointer(key)] = value;
  write_file(file, json.dump());
}

}  // namespace mocaplm
