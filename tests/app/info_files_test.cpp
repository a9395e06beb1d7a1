// info on every kind of file that the program reads or writes, and on others.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "model/directory.h"
#include "support/refusal.h"
#include "support/small_models.h"

namespace fs = std::filesystem;

namespace mocaplm::info_files_test {
namespace {

class InfoFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    must(
        "synth --out dances --genres WA,HO --dancers 1 --choreographies 2 --seconds 3 --fps 20 "
        "--json splits.json");
    fs::copy_file(first_clip(), path("clip.npz"));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path path(const std::string& name) { return *folder_ / name; }
  static fs::path first_clip() { return fs::directory_iterator(path("dances/clips"))->path(); }
  static Ran run(const std::string& words) {
    return run_shell("cd '" + folder_->path().string() + "' && " MOCAPLM_BINARY_DIR "/mocaplm " +
                     words);
  }
  static void must(const std::string& words) {
    const Ran ran = run(words);
    ASSERT_EQ(ran.code, 0) << words << "\n" << ran.text;
  }
  // info of `name` is sound and says all of these.
  static void says(const std::string& name, const std::vector<std::string>& parts) {
    const Ran ran = run("info '" + name + "' --json info.json");
    ASSERT_EQ(ran.code, 0) << ran.text;
    for (const std::string& part : parts)
      EXPECT_TRUE(contains(ran.text, part)) << name << ": " << part << " is not in\n" << ran.text;
    EXPECT_FALSE(load_json(path("info.json")).empty());
  }
  static void refused(const std::string& name, const std::string& part) {
    const Ran ran = run("info '" + name + "'");
    EXPECT_EQ(ran.code, 3) << name << "\n" << ran.text;
    EXPECT_TRUE(contains(ran.text, name)) << ran.text;
    EXPECT_TRUE(contains(ran.text, part)) << ran.text;
  }
  static StoredModel small_model() {
    StoredModel stored;
    stored.description = small_description();
    stored.tensors = random_weights(stored.description, 1);
    stored.tokenizer = Json::object();
    return stored;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};

std::unique_ptr<TemporaryFolder> InfoFiles::folder_;

TEST_F(InfoFiles, MotionTablesPagesAndPictures) {
  says("clip.npz", {"motion file", "frames per second", "pelvis height"});
  must("filter clip.npz --out slow --plot slow.svg --json slow.json");
  says("slow.npz", {"motion file"});
  says("slow.bvh", {"motion file", "skeleton"});
  says("slow.html", {"page", "Some frequencies of a motion", "MB"});
  says("slow.svg", {"picture (SVG)"});
  says("slow.json", {"table", "columns", "rows"});
  says("splits.json", {"table", "split"});
  says("dances", {"waack", "Procedural dances"});
  says("dances/dataset.json", {"waack"});
}

// What a newcomer has: recordings that are not imported yet.
TEST_F(InfoFiles, FoldersOfMotionFiles) {
  for (const char* name : {"mocap/waltz/a.bvh", "mocap/waltz/b.BVH", "mocap/c.npz", "mocap/notes"})
    write_file(path(name), "");
  says("mocap", {"folder of motion files", ".bvh", "2", ".npz", "mocaplm import mocap --out"});
}

TEST_F(InfoFiles, WhatConvertAndRenderWrite) {
  must("convert clip.npz clip.glb");
  says("clip.glb", {"glTF", "made by", "skins", "animation clip", "2.95 s"});
  must("convert clip.npz joints.csv");
  says("joints.csv", {"motion file"});
  must("render clip.npz --width 100 --height 80 --out clip.png");
  says("clip.png", {"picture (PNG)", "100 x 80"});
  write_file(path("moving.gif"), "GIF89a" + std::string("\x40\x01\xf0\x00", 4) + "rest");
  says("moving.gif", {"film (GIF)", "320 x 240"});
  write_file(path("moving.mp4"), std::string("\0\0\0\x20", 4) + "ftypisom");
  says("moving.mp4", {"film (MP4)"});
  for (const char* name : {"text.glb", "text.png", "text.gif", "text.mp4"}) {
    write_file(path(name), "a text");
    refused(name, "does not begin as");
  }
  write_file(path("cut.glb"), read_file(path("clip.glb")).substr(0, 300));
  refused("cut.glb", "the file ends after 280");
}

TEST_F(InfoFiles, TokenizersAndCorpora) {
  must("tokenize dances --out words --text --joints right_arm --bins 30");
  says("words/tokenizer.json", {"tokenizer", "bins", "30"});
  says("words", {"tokenizer"});
  says("words/corpus.txt", {"text corpus", "clips", "words", "frames", "tokenizer.json"});
  says("words/corpus.clips.json", {"index of a text corpus", "clips"});
  must("tokenize dances --out tiles.json --tiles 4 --keep 0.5 --joints right_arm");
  says("tiles.json", {"tile tokenizer", "components"});
  write_file(path("notes.txt"), "to do\n");
  refused("notes.txt", "notes.clips.json");
}

TEST_F(InfoFiles, FilesOfOtherCommands) {
  must("query --index dances clip.npz --fps 20 --window 32 --keep index");
  for (const auto& entry : fs::directory_iterator(path("index")))
    says("index/" + entry.path().filename().string(),
         {"spectral index", "stft", "windows", "clips"});
  must("emulate fit dances --where genre=waack --split all --iterations 1 --out waack.json");
  says("waack.json", {"emulator", "SIEM/SequentialPCA/MVG", "genre=waack"});
  must(
      "gesture juggle --demonstrations 20 --cycles 3 --write-demonstrations shown.csv --out "
      "juggler.json");
  says("juggler.json", {"gesture model", "phase toss", "demonstrations", "x, y"});
  says("shown.csv", {"table (CSV)", "time", "Trajectories"});
  must("import dances/clips --out imported --json report.json");
  says("report.json", {"report of an import", "imported"});
}

TEST_F(InfoFiles, ModelsAndRuns) {
  const StoredModel stored = small_model();
  save_model(path("run/best"), stored);
  save_model(path("run/last"), stored, [](const fs::path& folder) {
    save_json(folder / "state.json",
              {{"step", 40}, {"best_nats", 1.5}, {"seconds", 90.0}, {"smooth", 1.4}});
  });
  save_json(path("run/settings.json"), {{"config", {{"train", {{"steps", 100}}}}},
                                        {"data", "/where/dances"},
                                        {"from", "/where/base"}});
  std::string log;
  for (const auto& [step, bits] :
       std::vector<std::pair<int, double>>{{20, 70.5}, {30, 66.25}, {40, 68.0}})
    log += Json{{"step", step},
                {"validation_loss", bits / 40},
                {"validation_bits_per_frame", bits},
                {"tokens_per_second", 1234.0},
                {"seconds", 2.0 * step}}
               .dump() +
           "\n";
  write_file(path("run/log.jsonl"), log);
  says("run", {"training run", "/where/dances", "/where/base", "40 of 100",
               "66.25 bits/frame at best (step 30), 68.00 at last", "1234 tokens/s",
               "train --resume --out run", "vocabulary"});
  says("run/log.jsonl", {"log of a training run", "3", "66.25"});
  says("run/settings.json", {"settings of a training run", "/where/dances"});
  says("run/last/state.json", {"state of a training run", "40"});
  says("run/best", {"model", "vocabulary"});
  says("run/best/model.safetensors", {"weights", "tensors", "block.0.up.weight"});
  says("run/best/complete", {"files of a model"});
  StoredModel classifier = small_model();
  classifier.description.classes = {{"genre", {"house", "waack"}}};
  save_model(path("classifier"), classifier);
  says("classifier", {"classifier on a model", "classifies genre", "house, waack"});
}

TEST_F(InfoFiles, SettingsAndExperiments) {
  save_json(path("small.json"), {{"model", {{"n_layer", 2}}}, {"train", {{"steps", 5}}}});
  says("small.json", {"settings for train --config", "model.n_layer", "train.steps"});
  save_json(path("map.json"), {{"joints", Json::object()}});
  refused("map.json", "is missing: which joint");
  save_json(path("table.json"),
            {{"title", "Two"}, {"config", Json::object()}, {"rows", {{{"name", "a"}}}}});
  says("table.json", {"experiment", "Two", "1 entry"});
  for (const char* row : {"a", "b"})
    save_json(path("out") / row / "request.json",
              {{"name", row}, {"config", Json::object()}, {"trained on", "x"}, {"tested on", "x"}});
  save_json(path("out/a/result.json"),
            {{"name", "a"}, {"bits_of_a_frame", {1.0}}, {"accuracy", Json::array()}});
  says("out", {"row of an experiment", "finished", "begun", "goes on"});
  says("out/a/result.json", {"result of an experiment's row"});
  save_json(path("range_test.json"), {{"rates", {1.0}}, {"losses", {1.0}}, {"proposed", 0.1}});
  says("range_test.json", {"learning-rate range test", "proposed"});
  write_file(path("frames.jsonl"),
             "{\"dance\": 0, \"poses\": []}\n{\"dance\": 0, \"poses\": []}\n");
  says("frames.jsonl", {"stream of frames", "2"});
}

TEST_F(InfoFiles, OthersAreRefused) {
  write_file(path("other.json"), R"({"apples": 3, "pears": [1, 2]})");
  refused("other.json", "its keys: \"apples\", \"pears\"");
  write_file(path("other2.json"), R"({"format": "another program's"})");
  refused("other2.json", "another program's");
  write_file(path("list.json"), "[1, 2, 3]");
  refused("list.json", "a list");
  write_file(path("other.html"), "<html><title>Mine</title></html>");
  refused("other.html", "not one of this program's");
  write_file(path("other.svg"), "no picture");
  refused("other.svg", "no <svg>");
  write_file(path("other.jsonl"), "{\"a\": 1}\n");
  refused("other.jsonl", "line 1");
  write_file(path("empty.jsonl"), "");
  refused("empty.jsonl", "JSON");
  write_file(path("x.index"), std::string(5000, 'x'));
  refused("x.index", "x.index");
  write_file(path("x.safetensors"), "x");
  refused("x.safetensors", "x.safetensors");
  write_file(path("x.model"), std::string(50, '\xff'));
  refused("x.model", "x.model");
  write_file(path("x.cpp"), "int main() {}");
  refused("x.cpp", "x.cpp");
  fs::create_directories(path("nothing"));
  refused("nothing", "neither a dataset");
  // A run whose settings are damaged is said, not crashed on.
  save_model(path("damaged/last"), small_model());
  for (const char* settings : {"[]", "{\"config\": 3}", "{}", "{"}) {
    write_file(path("damaged/settings.json"), settings);
    const Ran ran = run("info damaged");
    EXPECT_TRUE(ran.code == 0 || ran.code == 3) << settings << "\n" << ran.text;
  }
}

}  // namespace
}  // namespace mocaplm::info_files_test
