// Configs and datasets that are wrong: a message that names the key or file, and nothing changed.
#include "app/trained_run.h"

namespace fs = std::filesystem;

namespace mocaplm::data_failures_test {
namespace {

using DataFailures = TrainedRun;

TEST_F(DataFailures, ConfigsNameTheKey) {
  const auto bad = [](const std::string& key, const Json& value, int code,
                      const std::string& part) {
    Json json = config();
    json[Json::json_pointer(key)] = value;
    write_file(path("bad.json"), json.dump());
    refused("train --threads 1 --config " + at("bad.json") + " --data " + at("data") + " --out " +
                at("new"),
            code, part);
  };
  bad("/model/n_layers", 2, 3, "n_layer");
  bad("/model/n_layer", "2", 3, "n_layer");
  bad("/model/n_head", 3, 2, "n_head");
  bad("/train/conditions", {"gnre"}, 2, "did you mean \"genre\"");
  bad("/tokenizer/joints", {"pelvs"}, 2, "did you mean \"pelvis\"");
  for (const char* text : {"", "{\"train\": {\"learning_rate\": NaN}}"}) {
    write_file(path("bad.json"), text);
    refused("train --config " + at("bad.json") + " --data " + at("data") + " --out " + at("new"), 3,
            "bad.json");
  }
}

TEST_F(DataFailures, DamagedDatasetsNameTheFile) {
  const auto all_refuse = [](const std::string& part) {
    refused("train --threads 1 --config " + at("config.json") + " --data " + at("bad") + " --out " +
                at("new"),
            3, part);
    refused("evaluate --threads 1 --model " + at("run") + " --data " + at("bad"), 3, part);
    refused("classify --threads 1 --steps 1 --model " + at("run") + " --data " + at("bad"), 3,
            part);
  };
  make_bad("data", [](const fs::path& bad) {
    const std::string text = read_file(bad / "dataset.json");
    write_file(bad / "dataset.json", text.substr(0, text.size() / 2));
  });
  all_refuse("dataset.json");
  make_bad("data",
           [](const fs::path& bad) { edit_json(bad / "dataset.json", "/clips/0/fps", "x"); });
  all_refuse("fps");
  make_bad("data", [](const fs::path& bad) {
    edit_json(bad / "dataset.json", "/clips/0/file", "../../config.json");
  });
  all_refuse("dataset.json");
  make_bad("data", [&](const fs::path& bad) {
    Json json = load_json(bad / "dataset.json");
    for (Json& one : json["clips"]) one["split"] = "train";
    write_file(bad / "dataset.json", json.dump());
  });
  all_refuse("split");
  make_bad("data", [&](const fs::path& bad) {
    for (const auto& entry : fs::directory_iterator(bad / "clips"))
      fs::resize_file(entry.path(), 500);
  });
  all_refuse(".npz");
}

}  // namespace
}  // namespace mocaplm::data_failures_test
