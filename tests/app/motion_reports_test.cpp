// What import and info say of motion files: how the figure stands, slips, what is unlikely, and the
// same trouble of many files once.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "motion/floor.h"
#include "motion/formats/bvh.h"

namespace mocaplm::motion_reports_test {
namespace {

class MotionReports : public ::testing::Test {
 protected:
  // A figure that stands still for `frames` frames, written as .bvh text.
  static std::string standing(Eigen::Index frames = 20) {
    Clip clip;
    clip.name = "standing";
    clip.fps = 30;
    clip.poses.setZero(frames, 72);
    clip.trans.setZero(frames, 3);
    stand_on_ground(clip);
    return bvh_text(clip);
  }
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return text.replace(at, from.size(), to);
  }
  std::string at(const std::string& name) const { return "'" + (folder_ / name).string() + "'"; }

  TemporaryFolder folder_;
};

TEST_F(MotionReports, InfoSaysHowTheFigureStands) {
  write_file(folder_ / "a.bvh", with(standing(), "Frames: 20", "Frames: 19"));
  const Ran ran = run_mocaplm("info " + at("a.bvh"));
  EXPECT_EQ(ran.code, 0) << ran.text;
  for (const char* part :
       {"hip line, right to left", "(0.14, ", "shoulder line, right to left", "(0.35, ",
        "pelvis to head", "left foot", "height, sole to crown", "1.73 m", "lowest foot joint",
        "planted feet slide at", "0.0 cm/s", "unit", "0.01 m",
        "\"Frames:\" announces 19, 20 whole frames are there and read."})
    EXPECT_NE(ran.text.find(part), std::string::npos) << part << " is not in\n" << ran.text;
  EXPECT_EQ(ran.text.find("Unlikely"), std::string::npos) << ran.text;
  expect_run("import " + at("a.bvh") + " --unit 0.02 --out " + at("set"), 0,
             "another unit may be right (--unit)");
}

TEST_F(MotionReports, ImportSaysTheSameTroubleOnce) {
  std::filesystem::create_directories(folder_ / "in");
  for (int i = 0; i < 30; ++i) {
    const std::string n = std::to_string(i);
    write_file(folder_ / "in" / ("lfs" + n + ".bvh"),
               "version https://git-lfs.github.com/spec/v1\n");
    write_file(folder_ / "in" / ("slip" + n + ".bvh"),
               with(standing(20 + i), "Frames: ", "Frames: 1"));
    write_file(folder_ / "in" / ("gap" + n + ".bvh"), standing(3) + "nan 0 0\n");
  }
  const Ran ran =
      run_mocaplm("import " + at("in") + " --json " + at("r.json") + " --out " + at("set"));
  EXPECT_EQ(ran.code, 3) << ran.text;
  for (const char* part :
       {"Left out: 30 files for the same reason; for example ", "is a Git LFS pointer",
        "Note: 30 files: frames announced; for example ", "Figures", "sole to crown, m"})
    EXPECT_NE(ran.text.find(part), std::string::npos) << part << " is not in\n" << ran.text;
  std::size_t said = 0;
  for (std::size_t i = 0; (i = ran.text.find("Git LFS pointer", i)) != std::string::npos; ++i)
    ++said;
  EXPECT_EQ(said, 2u) << ran.text;  // at once and in the end
  const Json json = load_json(folder_ / "r.json");
  EXPECT_EQ(json.at("broken").size(), 60u);
  EXPECT_EQ(json.at("remarks").size(), 30u);
  EXPECT_EQ(json.at("figures").at("rows").at(5).at("measure"), "sole to crown, m");
}

TEST_F(MotionReports, TheNamesOfOtherCommandsAreTaken) {
  write_file(folder_ / "a.bvh", standing());
  expect_run("import " + at("a.bvh") + " --source-fps 50 --bvh-map x.json --out " + at("set"), 3,
             "x.json");
  expect_run("import " + at("a.bvh") + " --source-fps 50 --fps 50 --out " + at("set"), 2, "--fps");
}

}  // namespace
}  // namespace mocaplm::motion_reports_test
