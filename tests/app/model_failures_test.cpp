// Damaged models and impossible wishes: every command that reads a model names the file or option.
#include "app/trained_run.h"

namespace fs = std::filesystem;

namespace mocaplm::model_failures_test {
namespace {

using ModelFailures = TrainedRun;

class Damaged : public TrainedRun {
 protected:
  // The commands that load the weights; with_torch also those that take seconds to start.
  static void all_refuse(const std::string& part, bool with_torch) {
    refused("generate --seconds 0.1 --model " + at("bad") + " --out " + at("new"), 3, part);
    if (!with_torch) return;
    const std::string data = " --threads 1 --data " + at("data");
    refused("evaluate --model " + at("bad") + data, 3, part);
    refused("classify --steps 1 --model " + at("bad") + data, 3, part);
    refused("train --config " + at("config.json") + " --from " + at("bad") + data + " --out " +
                at("new"),
            3, part);
  }
};

TEST_F(Damaged, TruncatedOrMissingFilesAreNamed) {
  for (const char* file : {"model.safetensors", "config.json", "tokenizer.json", "selftest.json"}) {
    make_bad("run/best", [&](const fs::path& bad) {
      fs::resize_file(bad / file, fs::file_size(bad / file) / 2);
    });
    all_refuse(file, file == std::string("model.safetensors"));
    make_bad("run/best", [&](const fs::path& bad) { write_file(bad / file, ""); });
    all_refuse(file, false);
    make_bad("run/best", [&](const fs::path& bad) { fs::remove(bad / file); });
    all_refuse(file, false);
  }
  make_bad("run/best", [](const fs::path& bad) { fs::remove(bad / "complete"); });
  all_refuse("complete", false);
  make_bad("run/best", [](const fs::path& bad) { write_file(bad / "complete", "[]"); });
  all_refuse("complete", false);
}

// The marker agrees with the files: what is inside is what is wrong.
TEST_F(Damaged, WrongInsideIsFoundToo) {
  const auto wrong = [](const std::string& file, const std::string& key, const Json& value,
                        const std::string& part, bool with_torch = false) {
    make_bad("run/best", [&](const fs::path& bad) {
      edit_json(bad / file, key, value);
      sign(bad);
    });
    all_refuse(part, with_torch);
  };
  wrong("tokenizer.json", "/settings/bins", 31, "tokenizer.json", true);
  wrong("config.json", "/model/n_embd", 8192, "model.safetensors");
  wrong("config.json", "/model/n_layer", 96, "model.safetensors");
  wrong("config.json", "/model/n_head", 3, "n_head");
  wrong("config.json", "/model/n_layer", -1, "n_layer");
  wrong("config.json", "/model/position", "absolute", "bad");
  wrong("config.json", "/model/reach", 30, "bad");
  wrong("selftest.json", "/0/logits/5", 99, "self-test");
  wrong("selftest.json", "/0/token/0", 99999, "99999");
  wrong("selftest.json", "/0/token", Json::array(), "selftest.json");
}

TEST_F(Damaged, WeightsThatAreNoModel) {
  make_bad("run/best", [](const fs::path& bad) {
    std::string bytes = read_file(bad / "model.safetensors");
    for (std::size_t i = bytes.size() - 4000; i < bytes.size(); ++i) bytes[i] = '\xff';  // NaN
    write_file(bad / "model.safetensors", bytes);
    sign(bad);
  });
  all_refuse("bad", true);
  make_bad("run/best", [](const fs::path& bad) {
    write_file(bad / "model.safetensors", std::string(64, '\xff'));
    sign(bad);
  });
  all_refuse("model.safetensors", false);
}

TEST_F(Damaged, InfoSpeaksOfModelsItCannotRead) {
  make_bad("run/best", [](const fs::path& bad) { write_file(bad / "config.json", "{"); });
  refused("info " + at("bad"), 3, "config.json");
  make_bad("run", [](const fs::path& bad) { fs::remove_all(bad / "best"); });
  fs::remove_all(path("bad/last"));
  refused("info " + at("bad"), 3, "bad");
  make_bad("run/best", [](const fs::path& bad) {
    fs::resize_file(bad / "model.safetensors", fs::file_size(bad / "model.safetensors") - 1);
  });
  refused("info " + at("bad"), 3, "model.safetensors");
}

TEST_F(Damaged, ResumeNamesWhatIsBroken) {
  for (const char* file : {"last/optimizer.safetensors", "last/state.json", "settings.json"}) {
    make_bad("run", [&](const fs::path& bad) {
      fs::resize_file(bad / file, fs::file_size(bad / file) / 2);
    });
    refused("train --threads 1 --resume --out " + at("bad"), 3, file);
  }
  make_bad("run", [](const fs::path& bad) { fs::remove(bad / "settings.json"); });
  refused("train --threads 1 --resume --out " + at("bad"), 3, "settings.json");
}

TEST_F(ModelFailures, GenerateNamesTheOption) {
  const std::string generate = "generate --model ";
  refused("generate", 2, "--model");
  refused(generate + at("tuned") + " --nonsense", 2, "nonsense");
  refused(generate + at("none"), 3, "none");
  refused(generate + at("config.json"), 3, "config.json");
  refused(generate + at("data"), 3, "data");
  for (const char* value : {"nan", "0", "-1", "inf", "x", "1e9", ""})
    refused(generate + at("tuned") + " --seconds '" + value + "'", 2, "--seconds");
  for (const char* value : {"nan", "0", "-1", "inf", "x"})
    refused(generate + at("tuned") + " --temperature " + value, 2, "--temperature");
  for (const char* value : {"nan", "0", "1.1", "-inf"})
    refused(generate + at("tuned") + " --top-p " + value, 2, "--top-p");
  refused(generate + at("tuned") + " --top-k -1", 2, "--top-k");
  refused(generate + at("tuned") + " --count 0", 2, "--count");
  refused(generate + at("tuned") + " --seed 1.5", 2, "--seed");
  refused(generate + at("tuned") + " --batch 0", 2, "--batch");
  refused(generate + at("tuned") + " --batch 65", 2, "--batch");
  refused(generate + at("tuned") + " --precision f16", 2, "--precision");
  refused(generate + at("tuned") + " --stream " + at("config.json"), 2, "config.json");
  refused(generate + at("tuned") + " --stream " + at("config.json/frames"), 3, "config.json");
  refused(generate + at("tuned") + " --strategy beam", 2, "--strategy");
  refused(generate + at("tuned") + " --prompt-seconds -1", 2, "--prompt-seconds");
  refused(generate + at("tuned") + " --joints pelvis", 2, "--prompt");
  refused(generate + at("tuned") + " --seconds 0.1 --out " + at("config.json/new"), 3,
          "config.json");
}

TEST_F(ModelFailures, GenerateNamesTheConditionsThereAre) {
  const std::string generate = "generate --seconds 0.1 --out " + at("new") + " --model ";
  refused(generate + at("tuned") + " --genre wack", 3, "did you mean \"waack\"");
  refused(generate + at("tuned") + " --genre polka", 3, "house, waack");
  refused(generate + at("tuned") + " --label gnre=waack", 3, "did you mean \"genre\"");
  refused(generate + at("tuned") + " --label zzz=waack", 3, "situation");
  refused(generate + at("tuned") + " --label genre", 2, "name=value");
  refused(generate + at("run") + " --genre waack", 3, "--genre");
}

TEST_F(ModelFailures, PromptsThatAreBroken) {
  const std::string generate =
      "generate --seconds 0.1 --model " + at("tuned") + " --out " + at("new") + " --prompt ";
  const std::string clip = "data/clips/gHO_sBM_cAll_d19_mHO1_ch01.npz";
  refused(generate + at("none.npz"), 3, "none.npz");
  refused(generate + at("data"), 2, "expected one: name it as");
  refused(generate + at("config.json"), 3, "config.json");
  const std::string sound = read_file(path(clip));
  for (const char* name : {"bad.npz", "bad.bvh", "bad.pkl"})
    for (const std::string& bytes :
         {std::string(), sound.substr(0, sound.size() / 2), std::string(3000, '\0')}) {
      write_file(path(name), bytes);
      refused(generate + at(name), 3, name);
      refused("view " + at(name) + " --out " + at("new.html"), 3, name);
    }
  refused(generate + at(clip) + " --joints pelvs", 2, "did you mean \"pelvis\"");
  refused(generate + at(clip) + " --joints left_knee", 2, "right_shoulder");
  refused("generate --seconds 0.1 --model " + at("tuned") + " --prompt " + at(clip) + " --out " +
              at(clip.substr(0, clip.size() - 4)),
          2, "would replace a file that is read");
}

}  // namespace
}  // namespace mocaplm::model_failures_test
