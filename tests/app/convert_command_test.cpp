// convert as it is called: every ending, parts, folders, datasets, refusals.
#include <gtest/gtest.h>

#include "app/command_line.h"
#include "common/csv.h"
#include "common/files.h"
#include "common/json.h"
#include "common/temporary_folder.h"
#include "motion/edit.h"
#include "motion/floor.h"
#include "motion/formats/formats.h"
#include "motion/formats/npy.h"
#include "motion/formats/npz.h"
#include "motion/formats/zip_file.h"
#include "motion/mirror.h"
#include "motion/skeleton.h"
#include "support/glb_file.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::convert_command_test {
namespace {

class Convert : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    write_dataset(*folder_ / "data", {{"a", "train", 80, {{"genre", "x"}}, 20, 7},
                                      {"b", "test", 40, {{"genre", "x"}}, 20, 8}});
    write_npz(*folder_ / "walk.npz", random_clip(9, 60, 30, "walk"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string at(const std::string& name) { return (*folder_ / name).string(); }
  static Clip walk() { return read_npz(at("walk.npz")); }

  static void converts(const std::string& arguments) {
    const Ran ran = run_mocaplm("convert " + arguments);
    ASSERT_EQ(ran.code, 0) << arguments << "\n" << ran.text;
  }
  static void refused(const std::string& arguments, int code, const std::string& part) {
    expect_run("convert " + arguments, code, part);
  }

  static double way_apart(const Clip& a, const Clip& b) {
    EXPECT_EQ(a.frames(), b.frames());
    double most = 0;
    for (Eigen::Index t = 0; t < std::min(a.frames(), b.frames()); ++t)
      most = std::max(most, (joint_positions(a, t) - joint_positions(b, t)).cwiseAbs().maxCoeff());
    return most;
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* Convert::folder_ = nullptr;

TEST_F(Convert, GoesThroughEveryEndingThatIsRead) {
  converts(at("walk.npz") + " " + at("cm.bvh"));
  converts(at("cm.bvh") + " " + at("again.npz"));
  converts(at("again.npz") + " --write-unit m " + at("m.bvh"));
  for (const char* name : {"cm.bvh", "again.npz", "m.bvh"}) {
    const Clip back = read_clip(at(name));
    EXPECT_LT(way_apart(back, walk()), 1e-6) << name;
    EXPECT_EQ(back.fps, 30) << name;
  }
}

TEST_F(Convert, WritesAFigureAndATableOfJoints) {
  converts(at("walk.npz") + " " + at("walk.glb") + " --json " + at("table.json"));
  const GlbFile file(read_file(at("walk.glb")));
  const Float3 hand = file.pose(41).positions[22];
  const JointPositions truth = joint_positions(walk(), 41);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(hand[i], truth(22, static_cast<Eigen::Index>(i)), 1e-5);
  const Json row = load_json(at("table.json"))["rows"][0];
  EXPECT_EQ(row["file"], at("walk.glb"));
  EXPECT_EQ(row["frames"], 60);

  converts(at("walk.npz") + " " + at("walk.csv"));
  const Csv table = read_csv(at("walk.csv"));
  ASSERT_EQ(table.rows.size(), 60u);
  EXPECT_NEAR(std::stod(table.rows[41][table.column("left_hand_y")]), truth(22, 1), 1e-6);
}

TEST_F(Convert, WritesTheSkeletonsOfOtherPrograms) {
  const auto names = [](const std::string& file) {
    std::vector<std::string> found;
    const GlbFile glb(read_file(file));
    for (const Json& node : glb.json["nodes"]) found.push_back(node["name"]);
    return found;
  };
  converts(at("walk.npz") + " " + at("mixamo.bvh") + " --skeleton mixamo");
  EXPECT_NE(read_file(at("mixamo.bvh")).find("ROOT mixamorig:Hips"), std::string::npos);
  EXPECT_LT(way_apart(read_clip(at("mixamo.bvh")), walk()), 1e-3);
  converts(at("walk.npz") + " " + at("unreal.glb") + " --skeleton unreal");
  EXPECT_EQ(names(at("unreal.glb"))[1], "pelvis");
  converts(at("data") + " " + at("vrm") + " --to vrma");
  EXPECT_EQ(names(at("vrm/a.vrma"))[0], "hips");
  converts(at("walk.npz") + " " + at("same.vrma") + " --skeleton vrm");
}

TEST_F(Convert, PutsTheMotionOnACharacter) {
  converts(at("walk.npz") + " " + at("hero.glb") + " --skeleton mixamo");
  const std::string before = read_file(at("hero.glb"));
  converts(at("data") + " " + at("heroes") + " --to glb --character " + at("hero.glb"));
  EXPECT_EQ(GlbFile(read_file(at("heroes/a.glb"))).json["animations"].size(), 2u);
  const std::string walk = at("walk.npz"), hero = " --character " + at("hero.glb");
  refused(walk + " " + at("y.bvh") + hero, 2, ".glb");
  refused(walk + " " + at("y.glb") + " --skeleton vrm" + hero, 2, "skeleton");
  refused(walk + " " + at("hero.glb") + hero, 2, "is read");
  refused(walk + " " + at("y.glb") + " --character " + walk, 3, "glTF");
  EXPECT_EQ(read_file(at("hero.glb")), before);
}

TEST_F(Convert, RefusesOptionsWithoutEffect) {
  const std::string walk = at("walk.npz");
  refused(walk + " " + at("y.npz") + " --skeleton unity", 2, ".bvh or a .glb");
  refused(walk + " " + at("y.csv") + " --skeleton unity", 2, ".bvh or a .glb");
  refused(walk + " " + at("y.vrma") + " --skeleton unity", 2, "vrm");
  refused(walk + " " + at("y") + " --to npz --skeleton cmu", 2, ".bvh or a .glb");
  refused(walk + " " + at("y.glb") + " --write-unit m", 2, "unit");
  refused(walk + " " + at("y.bvh") + " --skeleton mixame", 2, "mixamo");
  for (const char* name : {"y.npz", "y.csv", "y.vrma", "y", "y.glb", "y.bvh"})
    EXPECT_FALSE(fs::exists(at(name))) << name;
}

TEST_F(Convert, EditsOnTheWay) {
  converts(at("walk.npz") + ":0.5-1.5 " + at("part.npz") + " --face --floor --fps 15");
  const Clip part = read_npz(at("part.npz"));
  EXPECT_EQ(part.frames(), 15);
  EXPECT_EQ(part.fps, 15);
  EXPECT_NEAR(facing(part, 0), 0, 1e-9);
  EXPECT_NEAR(ground_height(part), 0, 1e-9);
  EditConfig edits;
  edits.fps = 15;
  edits.face = edits.floor = true;
  EXPECT_EQ(part.poses, edited(slice(walk(), 15, 30), edits).poses);

  converts(at("walk.npz") + " --mirror " + at("mirrored.npz"));
  EXPECT_EQ(read_npz(at("mirrored.npz")).poses, mirror(walk()).poses);
}

TEST_F(Convert, TakesTheRateThatAFileLacks) {
  const Clip clip = walk();
  const auto frames = static_cast<std::size_t>(clip.frames());
  write_zip(at("rateless.npz"), {{"poses.npy", npy_bytes(clip.poses.data(), {frames, 72})},
                                 {"trans.npy", npy_bytes(clip.trans.data(), {frames, 3})}});
  refused(at("rateless.npz") + " " + at("x.bvh"), 3, "--source-fps");
  converts(at("rateless.npz") + " " + at("rated.npz") + " --source-fps 40 --fps 20");
  EXPECT_EQ(read_npz(at("rated.npz")).fps, 20);
  EXPECT_EQ(read_npz(at("rated.npz")).frames(), 30);
}

TEST_F(Convert, FillsAFolder) {
  converts(at("data") + " " + at("walk.npz") + " " + at("walk.npz") + ":0-1 " + at("out") +
           " --to bvh --threads 2");
  for (const char* name : {"a.bvh", "b.bvh", "walk.bvh", "walk_0-1.bvh"})
    EXPECT_TRUE(fs::exists(*folder_ / "out" / name)) << name;
  EXPECT_EQ(read_clip(at("out/a.bvh")).frames(), 80);
  EXPECT_EQ(read_clip(at("out/walk_0-1.bvh")).frames(), 30);

  converts("--clip b:1-,a " + at("data") + " " + at("some") + " --to csv");
  EXPECT_EQ(read_csv(at("some/b_1-.csv")).rows.size(), 20u);
  EXPECT_EQ(std::distance(fs::directory_iterator(at("some")), fs::directory_iterator()), 2);

  converts(at("data") + " --clip b " + at("one.glb"));
  EXPECT_EQ(GlbFile(read_file(at("one.glb"))).json["animations"][0]["name"], "b");
}

TEST_F(Convert, RefusesWhatCannotBe) {
  const std::string walk = at("walk.npz");
  refused(walk, 2, "the file to write");
  refused(walk + " " + at("x.fbx"), 2, ".glb");
  refused(walk + " " + at("x.pkl"), 2, "must end in");
  refused(walk + " " + walk, 2, "another name");
  refused(walk + " " + walk + " " + at("x.bvh"), 2, "--to npz");
  refused(walk + " " + walk + " " + at("twice") + " --to bvh", 2, "both be written");
  refused(walk + " " + folder_->path().string() + " --to npz", 2, "another name");
  refused(walk + " " + walk + " --to npz", 2, "is a file");
  refused(walk + ":5-6 " + at("x.bvh"), 2, "begins at 5");
  refused(walk + " " + at("x.bvh") + " --fps 0.000001 --write-unit inch", 2, "inch");
  refused(at("data") + " --clip c " + at("x.bvh"), 2, "no clip is named");
  refused(walk + " --clip a " + at("x.bvh"), 2, "none was given");
  refused(at("none.npz") + " " + at("x.bvh"), 3, "none.npz");
  refused(walk + " " + at("none.npz") + " " + at("twice") + " --to bvh", 3, "no such file");
  refused(folder_->path().string() + " " + at("x") + " --to npz", 3, "dataset.json");
  EXPECT_FALSE(fs::exists(at("x.bvh")));
  EXPECT_FALSE(fs::exists(at("twice")));
}

// Not only its own source: one file's result could take the place of another one that is still to
// be read, and the table that of a motion.
TEST_F(Convert, NeverWritesOverAMotionThatIsRead) {
  const std::string folder = at("safe"), walk = folder + "/walk.npz", other = folder + "/walk.bvh";
  fs::create_directories(folder);
  fs::copy_file(at("walk.npz"), walk);
  converts(walk + " " + other);
  const std::string before = read_file(walk), text = read_file(other);
  refused(other + " " + walk + ":0-1 " + folder + " --to npz", 2, "is read");
  fs::create_symlink(walk, folder + "/link.npz");
  refused(other + " " + walk + ":0-1 " + folder + "/../safe --to npz", 2, "is read");
  refused(folder + "/link.npz " + folder + "/./walk.npz", 2, "is read");
  refused(walk + " " + at("x.glb") + " --json " + walk, 2, "is read");
  refused(walk + " " + at("x.glb") + " --json " + folder + "/../x.glb", 2, "twice");
  EXPECT_EQ(read_file(walk), before);
  EXPECT_EQ(read_file(other), text);
  EXPECT_FALSE(fs::exists(at("x.glb")));
}

}  // namespace
}  // namespace mocaplm::convert_command_test
