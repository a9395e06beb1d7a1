// mocaplm gesture: fit, test, play and juggle from the command line.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/csv.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::gesture_commands_test {
namespace {

constexpr const char* kPhases =
    " --phases 'toss: v_y < 0,down: y < -0.25,catch: event catch,return: near x=0.2 y=0 by 0.04'"
    " --cycle --min-seconds 0.2 ";

class Gesture : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }
  std::string run(const std::string& arguments) const {
    const Ran ran = run_mocaplm("gesture " + arguments);
    EXPECT_EQ(ran.code, 0) << ran.text;
    return ran.text;
  }
  void refused(const std::string& arguments, int code, const std::string& part) const {
    expect_run("gesture " + arguments, code, part);
  }
  void demonstrate() const {
    run("juggle --demonstrations 25 --cycles 5 --write-demonstrations " + at("shown.csv") +
        " --out " + at("own.json"));
  }
  TemporaryFolder folder_;
};

TEST_F(Gesture, TheWholeWalk) {
  demonstrate();
  run("fit " + at("shown.csv") + kPhases + "--out " + at("m.json") + " --json " + at("fit.json") +
      " --page " + at("fit.html"));
  EXPECT_EQ(load_json(folder_ / "fit.json")["rows"].size(), 4u);
  const std::string page = read_file(folder_ / "fit.html");
  EXPECT_PRED2(contains, page, "95% interval");
  // Numbers on hover, and nothing from elsewhere.
  EXPECT_PRED2(contains, page, "querySelectorAll");
  EXPECT_FALSE(contains(page, " src="));
  // The file's text has every digit, so this is the model that juggle made itself.
  EXPECT_EQ(load_json(folder_ / "m.json")["phases"][0]["f"],
            load_json(folder_ / "own.json")["phases"][0]["f"]);

  const std::string test = run("test " + at("shown.csv") + kPhases +
                               "--simulations 200 --partitions 5 --json " + at("test.json"));
  EXPECT_PRED2(contains, test, "left out: RMS error, mean shape");
  EXPECT_EQ(load_json(folder_ / "test.json").size(), 8u);

  const std::string juggled = run("juggle --cycles 20 --model " + at("m.json") + " --json " +
                                  at("j.json") + " --page " + at("j.html"));
  EXPECT_PRED2(contains, juggled, "balls caught");
  EXPECT_TRUE(fs::exists(folder_ / "j.html"));

  run("play --model " + at("m.json") +
      " --phase catch --from -0.05,-0.26 --to -0.2,0 --duration 0.4 --rate 100 --out " +
      at("p.csv"));
  const Csv csv = read_csv(folder_ / "p.csv");
  EXPECT_EQ(csv.columns, (std::vector<std::string>{"time", "x", "y", "phase"}));
  ASSERT_EQ(csv.rows.size(), 41u);
  EXPECT_NEAR(std::stod(csv.rows[0][1]), -0.05, 1e-9);
  EXPECT_NEAR(std::stod(csv.rows[40][2]), 0, 1e-9);
}

TEST_F(Gesture, PlayChangesMovements) {
  demonstrate();
  const std::string model = "play --model " + at("own.json");
  const std::string speeds =
      run(model + " --phase toss --end-velocity free,0 --on closest --page " + at("v.html"));
  EXPECT_PRED2(contains, speeds, "closest");
  EXPECT_TRUE(fs::exists(folder_ / "v.html"));
  const std::string corrected = run(model + " --phase catch --correct-at 0.5 --target -0.3,0.1");
  EXPECT_PRED2(contains, corrected, "smooth");
  const std::string all = run(model + " --cycles 3 --seed 4 --out " + at("all.csv"));
  EXPECT_PRED2(contains, all, "return");
  refused(model + " --from 1,2", 2, "give --phase too");
  refused(model + " --phase ctch", 2, "catch");
  refused(model + " --phase catch --from 1", 2, "--from needs 2 numbers");
  refused(model + " --phase catch --end-velocity 0", 2, "2 values");
  refused(model + " --phase catch --end-velocity 0,fast", 2, "\"fast\"");
  refused(model + " --phase catch --correct-at 1.5", 2, "--correct-at");
  refused("play --model " + at("shown.csv"), 3, "JSON");
}

TEST_F(Gesture, ClipsGiveAJointsPath) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 12; ++i)
    clips.push_back({"c" + std::to_string(i),
                     i < 10 ? "train" : "test",
                     40 + i,
                     {{"content", i % 2 ? "wave" : "walk"}},
                     30});
  write_dataset(folder_ / "data", clips);
  const std::string fit = run("fit " + at("data") +
                              " --joint left_wrist --conditions displacement "
                              "--out " +
                              at("m.json"));
  EXPECT_PRED2(contains, fit, "movement");
  run("fit " + at("data") + " --where content=wave --coordinates x --conditions end --out " +
      at("m.json"));
  EXPECT_EQ(load_json(folder_ / "m.json")["phases"][0]["demonstrations"].size(), 6u);
  refused("fit " + at("data") + " --where content=wav --out " + at("m.json"), 2, "wave");
  refused("fit " + at("data") + " --where contnt=wave --out " + at("m.json"), 2, "content");
  refused("fit " + at("data") + " --where content --out " + at("m.json"), 2, "label=value");
  refused("fit " + at("data") + " --joint left_wrst --out " + at("m.json"), 2, "left_wrist");
  refused("fit " + at("data") + " --coordinates w --out " + at("m.json"), 2, "\"w\"");
  refused("fit " + at("data") + " --conditions ball --out " + at("m.json"), 2, "\"ball\"");
  refused("fit " + at("data") + " --where content=wave --out " + at("m.json"), 3,
          "6 demonstrations, but 6 conditions");
  refused("fit " + at("data") + " x.csv --out " + at("m.json"), 2, "not both");
}

TEST_F(Gesture, ClipsThatTeachNothingAreNamed) {
  std::vector<SmallClip> clips;
  for (int i = 0; i < 10; ++i)
    clips.push_back({"c" + std::to_string(i),
                     "train",
                     i == 9 ? 1 : 30,
                     {{"content", i < 8    ? "walk"
                                  : i == 8 ? "jump"
                                           : "stand"}}});
  write_dataset(folder_ / "data", clips);
  const std::string test = "test " + at("data") + " --where content=";
  refused(test + "jump", 3, "has 1 demonstration, but 6 conditions");
  refused(test + "stand", 3, "c9: has one frame, a movement has several");
  // The pelvis stays where paths are measured from.
  refused(test + "walk --joint pelvis --conditions duration", 3, "coordinate \"x\" is");
}

TEST_F(Gesture, BadInputIsAClearAnswer) {
  write_file(folder_ / "one.csv", "time,x\n0,1\n");
  refused("fit " + at("one.csv") + " --out " + at("m.json"), 3, "one sample");
  write_file(folder_ / "nan.csv", "time,x\n0,1\n1,nan\n");
  refused("test " + at("nan.csv"), 3, "line 3: column \"x\"");
  write_file(folder_ / "same.csv", "time,x\n0,1\n0,2\n");
  refused("test " + at("same.csv"), 3, "line 3");
  std::string still = "trajectory,time,x,y\n";
  for (int i = 0; i < 9; ++i)
    for (int t = 0; t < 6; ++t)
      still += std::to_string(i) + "," + std::to_string(t) + "," + std::to_string(i * t) + ",5\n";
  write_file(folder_ / "still.csv", still);
  refused("fit " + at("still.csv") + " --out " + at("m.json"), 3, "coordinate \"y\" is 5");
  refused("fit " + at("still.csv") + " --phases 'a: z < 1' --out " + at("m.json"), 2, "\"z\"");
  run("fit " + at("still.csv") + " --coordinates x --out " + at("m.json"));
  refused("juggle --model " + at("m.json"), 3, "toss, down, catch and return");
  refused("juggle --model " + at("m.json") + " --out " + at("n.json"), 2, "--out");
  refused("juggle --toss-threshold 60", 2, "toss_threshold");
  refused("juggle --cycles 0", 2, "--cycles");
  refused("fit " + at("none.csv") + " --out " + at("m.json"), 3, "none.csv");
  refused("fit", 2, "required");
  EXPECT_EQ(run_mocaplm("gesture").code, 2);
}

}  // namespace
}  // namespace mocaplm::gesture_commands_test
