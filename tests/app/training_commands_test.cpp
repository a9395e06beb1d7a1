// The walk from dances to a page, every step a command; then what goes on and what does not.
#include <map>
#include <sstream>

#include "app/trained_run.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm::training_commands_test {
namespace {

using TrainingCommands = TrainedRun;

std::vector<Json> json_lines(const fs::path& path) {
  std::vector<Json> lines;
  std::istringstream text(read_file(path));
  for (std::string line; std::getline(text, line);)
    lines.push_back(parse_json(line, path.string()));
  return lines;
}

std::string prompt() {
  return "gWA_sBM_cAll_d25_mWA1_ch01";
}

TEST_F(TrainingCommands, ARunHoldsModelsALogAndItsSettings) {
  for (const char* run : {"run", "tuned"})
    for (const char* file :
         {"settings.json", "log.jsonl", "best/complete", "last/optimizer.safetensors"})
      EXPECT_TRUE(fs::exists(path(run) / file)) << run << "/" << file;
  EXPECT_NE(read_file(path("run/training.html")).find("<title>Bits a frame</title>"),
            std::string::npos);
  EXPECT_EQ(load_json(path("run/best/config.json"))["conditions"].size(), 0u);
  EXPECT_EQ(load_json(path("tuned/best/config.json"))["conditions"].size(), 5u);
  EXPECT_EQ(load_json(path("run/settings.json"))["config"]["train"]["steps"], 4);
  // --steps on the command line wins over the config file.
  EXPECT_EQ(load_json(path("tuned/settings.json"))["config"]["train"]["steps"], 2);
  for (const char* where : {"run", "tuned", "run/last", "run/best/config.json", "data"})
    must("info " + at(where) + " --json " + at("info.json"));
}

TEST_F(TrainingCommands, GenerateKeepsThePromptAndWritesThreeFiles) {
  const fs::path clip = path("data/clips/" + prompt() + ".npz");
  const std::string text =
      must("generate --model " + at("tuned") + " --prompt '" + clip.string() +
           "' --joints right_arm --genre waack --dancer d25 --seconds 1 --seed 3 --out " +
           at("dance") + " --json " + at("dance.json"));
  EXPECT_NE(text.find("procedural"), std::string::npos) << text;
  const Clip dance = read_clip(path("dance.npz"), {}), bvh = read_clip(path("dance.bvh"), {});
  EXPECT_EQ(dance.frames(), 20);
  EXPECT_EQ(bvh.frames(), 20);
  for (Eigen::Index t = 0; t < 20; ++t)
    EXPECT_LT((joint_positions(dance, t) - joint_positions(bvh, t)).cwiseAbs().maxCoeff(), 1e-4);
  // The prompt's own frames: 60 per second, every third is one of the model's.
  const Clip given = read_clip(clip, {});
  const int shoulder = 17;
  ASSERT_EQ(joint_names()[shoulder], "right_shoulder");
  for (Eigen::Index t = 0; t < 20; ++t)
    EXPECT_LT((dance.poses.row(t) - given.poses.row(3 * t)).segment<3>(3 * shoulder).norm(), 1e-5)
        << t;
  EXPECT_GT(fs::file_size(path("dance.html")), 100000u);
  EXPECT_NE(read_file(path("dance.html")).find("waack"), std::string::npos);
  EXPECT_TRUE(load_json(path("dance.json")).is_object());
}

TEST_F(TrainingCommands, GenerateContinuesCountsAndRepeats) {
  const std::string model = "generate --seconds 0.5 --model ";
  must(model + at("run") + " --count 2 --seed 5 --out " + at("free"));
  must(model + at("run") + " --seed 6 --out " + at("again.npz"));
  EXPECT_EQ(read_clip(path("free-2.npz"), {}).poses, read_clip(path("again.npz"), {}).poses);
  EXPECT_FALSE(fs::exists(path("again.bvh")));
  // Half a second more than one second of prompt.
  must(model + at("run") + " --prompt " + at("data/clips/" + prompt() + ".npz") +
       " --prompt-seconds 1 --strategy greedy --out " + at("more.bvh"));
  EXPECT_EQ(read_clip(path("more.bvh"), {}).frames(), 30);
  must("view " + at("free-1.npz") + " " + at("more.bvh") + " --out " + at("page.html"));
  EXPECT_GT(fs::file_size(path("page.html")), 100000u);
}

TEST_F(TrainingCommands, GenerateTellsFramesInEveryPrecision) {
  for (const char* precision : {"f32", "bf16", "int8"}) {
    must("generate --seconds 0.5 --count 3 --batch 2 --model " + at("run") + " --precision " +
         precision + " --out " + at("many") + " --stream " + at("frames.jsonl") + precision +
         " --json " + at("many.json"));
    EXPECT_EQ(load_json(path("many.json")).size(), 3u);
    std::map<int, int> frames;  // of each dance
    for (const Json& line : json_lines(path("frames.jsonl" + std::string(precision)))) {
      const int dance = line["dance"];
      const Clip clip = read_clip(path("many-" + std::to_string(dance + 1) + ".npz"), {});
      const int frame = frames[dance]++;
      ASSERT_EQ(line["frame"], frame);
      EXPECT_NEAR(line["seconds"].get<double>(), frame / 20.0, 1e-12);
      for (int i = 0; i < 72; ++i)
        ASSERT_NEAR(line["poses"][static_cast<std::size_t>(i)].get<double>(), clip.poses(frame, i),
                    1e-6);
      for (int i = 0; i < 3; ++i)
        ASSERT_NEAR(line["trans"][static_cast<std::size_t>(i)].get<double>(), clip.trans(frame, i),
                    1e-6);
    }
    EXPECT_EQ(frames, (std::map<int, int>{{0, 10}, {1, 10}, {2, 10}}));
  }
  // On standard output there are frames and nothing else; what is told beside goes to stderr.
  const std::string out = at("stdout.jsonl");
  must("generate --seconds 0.5 --model " + at("run") + " --out " + at("one") + " --stream - > " +
       out + " 2> /dev/null && true");
  EXPECT_EQ(json_lines(path("stdout.jsonl")).size(), 10u);
}

TEST_F(TrainingCommands, ClassifyPrintsTheThreeMethodsAndKeepsAClassifier) {
  const std::string classify = "classify --threads 1 --steps 2 --labels genre --model " +
                               at("run") + " --data " + at("data");
  const std::string text =
      must(classify + " --out " + at("classifier") + " --json " + at("classify.json"));
  for (const char* part : {"Majority class", "LDA", "Transformer", "house", "Balanced"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(load_json(path("classify.json")).size(), 5u);
  EXPECT_EQ(load_json(path("classifier/config.json"))["classes"].size(), 1u);
  EXPECT_NE(must("info " + at("classifier")).find("classifies genre"), std::string::npos);
  must(classify + " --out " + at("classifier") +  // an earlier classifier may be replaced
       " --page " + at("classes.html"));
  const std::string page = read_file(path("classes.html"));
  EXPECT_NE(page.find("<title>genre: what is taken for what</title>"), std::string::npos);
  EXPECT_NE(page.find("Transformer: "), std::string::npos);
  must("classify --threads 1 --model " + at("classifier") + " --json " + at("said.json") + " " +
       at("data/clips/" + prompt() + ".npz"));
  EXPECT_EQ(load_json(path("said.json")).at("rows").size(), 1u);
  refused("classify --model " + at("run") + " " + at("data/clips/" + prompt() + ".npz"), 2,
          "no classifier");
  refused(classify + " --out " + at("tuned"), 2, "tuned");
  refused(classify + " --out " + at("run/best"), 2, "no classifier");
  refused(classify + " --out " + at("data"), 2, "data");
}

TEST_F(TrainingCommands, EvaluatePrintsBitsBesideBaselines) {
  const std::string evaluate =
      "evaluate --threads 1 --model " + at("tuned") + " --data " + at("data");
  must(evaluate + " --by genre --json " + at("bits.json"));
  const Json tables = load_json(path("bits.json"));
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_NE(tables.dump().find("right_shoulder"), std::string::npos);
}

TEST_F(TrainingCommands, EvaluateForecastsAndMakesLongDances) {
  const std::string evaluate = "evaluate --threads 1 --data " + at("data");
  must(evaluate + " --forecast --split train --seed-seconds 0.4 --json " + at("simple.json"));
  EXPECT_EQ(load_json(path("simple.json")).size(), 4u);
  const std::string text =
      must(evaluate + " --forecast --split train --seed-seconds 0.4 --windows 2 --samples 2 " +
           "--all-joints --model " + at("run") + " --model " + at("tuned"));
  EXPECT_NE(text.find("run, best of 2"), std::string::npos) << text;
  EXPECT_NE(text.find("interpolated"), std::string::npos) << text;
  must(evaluate + " --long 1 --split train --seed-seconds 0.5 --dances 2 --model " + at("tuned") +
       " --json " + at("long.json"));
  EXPECT_EQ(load_json(path("long.json")).size(), 2u);
}

TEST_F(TrainingCommands, EvaluateRefusesWhatAnotherModeNeeds) {
  const std::string evaluate = "evaluate --data " + at("data");
  refused(evaluate, 2, "--model");
  refused(evaluate + " --long 5", 2, "--model");
  refused(evaluate + " --long 5 --forecast", 2, "--long");
  refused(evaluate + " --forecast --by genre", 2, "--by does nothing with --forecast");
  refused(evaluate + " --forecast --dances 3", 2, "--dances does nothing with --forecast");
  refused(evaluate + " --long 5 --horizons 100", 2, "--horizons does nothing with --long");
  const std::string run = " --model " + at("run");
  refused(evaluate + run + " --samples 3", 2, "--samples needs --forecast or --long");
  refused(evaluate + run + run, 2, "compare several");
  refused(evaluate + run + " --forecast --horizons 1", 2, "--horizons 1");
  refused(evaluate + run + " --forecast --seed-seconds 50", 3, "shorter --seed-seconds");
}

TEST_F(TrainingCommands, ResumeGoesOnWithTheRunsOwnSettings) {
  // A run cut off after its first checkpoint: last/ is as it was after 2 of 4 steps.
  const std::string train = "train --threads 1 --out ";
  Json config = TrainedRun::config();
  config["train"]["steps"] = 2;
  write_file(path("short.json"), config.dump());
  must(train + at("short") + " --config " + at("short.json") + " --data " + at("data"));
  edit_json(path("short/settings.json"), "/config/train/steps", 4);
  refused(train + at("short") + " --resume --steps 9", 2, "--steps");
  refused(train + at("short") + " --resume --config " + at("config.json"), 2, "--config");
  refused(train + at("short") + " --resume --from " + at("run"), 2, "--from");
  must(train + at("short") + " --resume");
  EXPECT_EQ(load_json(path("short/last/state.json"))["step"], 4);
}

}  // namespace
}  // namespace mocaplm::training_commands_test
