// VRM Animation files, against the tables of the specification.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "motion/floor.h"
#include "motion/formats/glb.h"
#include "motion/formats/skeleton_trees.h"
#include "support/glb_file.h"

namespace mocaplm::vrma_test {
namespace {

// VRMC_vrm-1.0, humanoid.md: the bones that must be there, and each bone's parent.
const std::map<std::string, std::string>& vrm_parents() {
  static const std::map<std::string, std::string> all = [] {
    std::map<std::string, std::string> parents = {{"hips", ""},           {"spine", "hips"},
                                                  {"chest", "spine"},     {"upperChest", "chest"},
                                                  {"neck", "upperChest"}, {"head", "neck"}};
    for (const std::string side : {"left", "right"}) {
      parents[side + "UpperLeg"] = "hips";
      parents[side + "LowerLeg"] = side + "UpperLeg";
      parents[side + "Foot"] = side + "LowerLeg";
      parents[side + "Toes"] = side + "Foot";
      parents[side + "Shoulder"] = "upperChest";
      parents[side + "UpperArm"] = side + "Shoulder";
      parents[side + "LowerArm"] = side + "UpperArm";
      parents[side + "Hand"] = side + "LowerArm";
    }
    return parents;
  }();
  return all;
}

TEST(Vrma, NamesEveryBoneOfVrmsHumanoid) {
  const GlbFile file(vrma_bytes(clip_of_another_body(20)));
  EXPECT_EQ(file.json["extensionsUsed"], Json::array({"VRMC_vrm_animation"}));
  const Json& extension = file.json["extensions"]["VRMC_vrm_animation"];
  EXPECT_EQ(extension["specVersion"], "1.0");
  const Json& bones = extension["humanoid"]["humanBones"];
  EXPECT_EQ(bones.size(), vrm_parents().size());
  for (const auto& [bone, parent] : vrm_parents()) {
    ASSERT_TRUE(bones.contains(bone)) << bone;
    const std::size_t node = bones[bone]["node"];
    ASSERT_LT(node, file.json["nodes"].size());
    if (parent.empty()) continue;
    const Json& children = file.json["nodes"][bones[parent]["node"].get<std::size_t>()]["children"];
    EXPECT_NE(std::find(children.begin(), children.end(), Json(node)), children.end()) << bone;
  }
}

TEST(Vrma, MovesTheHipsAndTurnsTheRest) {
  const GlbFile file(vrma_bytes(clip_of_another_body(21)));
  const std::size_t hips =
      file.json["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]["hips"]["node"];
  ASSERT_EQ(file.json["animations"].size(), 1u);
  std::size_t moved = 0;
  for (const Json& channel : file.json["animations"][0]["channels"]) {
    const std::string path = channel["target"]["path"];
    if (path == "translation") {
      ++moved;
      EXPECT_EQ(channel["target"]["node"], hips);
    } else {
      EXPECT_EQ(path, "rotation");
    }
  }
  EXPECT_EQ(moved, 1u);
  for (const char* part : {"meshes", "skins", "materials"}) EXPECT_FALSE(file.json.contains(part));
}

// VRMC_vrm-1.0, tpose.md, of the nodes as they lie without the animation.
TEST(Vrma, StandsInVrmsTPose) {
  for (const Clip& clip : {clip_of_another_body(22), clip_of_the_mean_body(23)}) {
    const GlbFile file(vrma_bytes(clip));
    const Json& bones = file.json["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"];
    std::vector<Eigen::Vector3d> places(file.json["nodes"].size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < places.size(); ++i) {  // parents come first
      const Json& node = file.json["nodes"][i];
      EXPECT_FALSE(node.contains("rotation") || node.contains("scale"));
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        places[i][axis] += node["translation"][static_cast<std::size_t>(axis)].get<double>();
      for (const Json& child : node.value("children", Json::array())) {
        ASSERT_GT(child.get<std::size_t>(), i);
        places[child.get<std::size_t>()] = places[i];
      }
    }
    const auto direction = [&](const std::string& from, const std::string& to) {
      const auto at = [&](const std::string& bone) {
        return places[bones[bone]["node"].get<std::size_t>()];
      };
      return Eigen::Vector3d((at(to) - at(from)).normalized());
    };
    for (const std::string side : {"left", "right"}) {
      const double left = side == "left" ? 1 : -1;
      EXPECT_NEAR(direction(side + "UpperArm", side + "LowerArm").x(), left, 1e-9);
      EXPECT_NEAR(direction(side + "LowerArm", side + "Hand").x(), left, 1e-9);
      EXPECT_NEAR(direction(side + "UpperLeg", side + "LowerLeg").y(), -1, 1e-9);
      EXPECT_NEAR(direction(side + "LowerLeg", side + "Foot").y(), -1, 1e-9);
      const Eigen::Vector3d foot = direction(side + "Foot", side + "Toes");
      EXPECT_NEAR(foot.x(), 0, 1e-9);
      EXPECT_GT(foot.z(), 0.7);
      EXPECT_NEAR(std::abs(direction("hips", side + "UpperLeg").x()),
                  left * direction("hips", side + "UpperLeg").x(), 1e-12);
    }
    EXPECT_GT(direction("hips", "head").y(), 0.95);
    double lowest = 10;
    for (const char* toes : {"leftToes", "rightToes"})
      lowest = std::min(lowest, places[bones[toes]["node"].get<std::size_t>()].y());
    EXPECT_NEAR(lowest, kSoleBelowFoot, 1e-9);
  }
}

TEST(Vrma, KeepsEveryJointWhereTheClipHasIt) {
  const Clip clip = clip_of_another_body(24);
  const GlbFile file(vrma_bytes(clip));
  const Json& bones = file.json["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"];
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const GlbFile::Pose pose = file.pose(static_cast<std::size_t>(t));
    const JointPositions truth = joint_positions(clip, t);
    for (const Named& named : parsed(trees().at("vrm"))) {
      const Float3& at = pose.positions[bones[named.name]["node"].get<std::size_t>()];
      EXPECT_LT((Eigen::RowVector3d(at[0], at[1], at[2]) - truth.row(named.smpl)).norm(), 1e-5)
          << named.name << " frame " << t;
    }
  }
}

}  // namespace
}  // namespace mocaplm::vrma_test
