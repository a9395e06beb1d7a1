// examples/blender/put_on_character.py: a dance of ours on a character, by Blender in background
// mode. Skipped where Blender is not installed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "common/find_program.h"
#include "motion/formats/character.h"
#include "motion/formats/formats.h"
#include "motion/formats/glb.h"
#include "motion/formats/helpers.h"
#include "motion/formats/skeleton_trees.h"
#include "motion/resample.h"
#include "support/run_program.h"

namespace mocaplm::blender_test {
namespace {

constexpr double kScale = 1.3;

// A figure on the ground that turns and bends.
Clip dance() {
  Random random(31);
  Clip keys = random_clip(random, 4, 3, 1.2);
  keys.trans.col(1).array() += 1;
  Clip clip = slice(resample(keys, 50), 0, 20);
  clip.name = "dance";
  return clip;
}

// The same body, larger: its joints go where the dance's do, so many times as far.
Clip large_body() {
  Random random(32);
  Clip clip = random_clip(random, 2, 30);
  BodyShape body;
  body.rest = kScale * rest_joints();
  clip.body = std::make_shared<const BodyShape>(body);
  return clip;
}

// SMPL's joint of a part of the script's.
int smpl_joint(const std::string& part) {
  static const std::map<std::string, int> all = {{"hips", 0},
                                                 {"spine1", 3},
                                                 {"spine2", 6},
                                                 {"spine3", 9},
                                                 {"neck", 12},
                                                 {"head", 15},
                                                 {"left_shoulder", 13},
                                                 {"left_upper_arm", 16},
                                                 {"left_hand", 20},
                                                 {"left_lower_arm", 18},
                                                 {"left_upper_leg", 1},
                                                 {"left_lower_leg", 4},
                                                 {"left_foot", 7},
                                                 {"left_toes", 10},
                                                 {"right_shoulder", 14},
                                                 {"right_upper_arm", 17},
                                                 {"right_hand", 21},
                                                 {"right_lower_arm", 19},
                                                 {"right_upper_leg", 2},
                                                 {"right_lower_leg", 5},
                                                 {"right_foot", 8},
                                                 {"right_toes", 11}};
  return all.at(part);
}

class Blender : public testing::Test {
 protected:
  void SetUp() override {
    blender_ = find_program("blender");
    if (blender_.empty())
      GTEST_SKIP() << "no Blender: apt-get install --no-install-recommends blender";
  }

  Ran run(const std::string& arguments) const {
    return run_shell("'" + blender_ +
                     "' -b --python '" MOCAPLM_SOURCE_DIR
                     "/examples/blender/put_on_character.py' -- " +
                     arguments);
  }
  std::string at(const std::string& name) const { return "'" + (scratch_ / name).string() + "'"; }

  // The line of JSON among what Blender says.
  static Json report_of(const Ran& ran) {
    const std::size_t begin = ran.text.find("{\"parts\"");
    EXPECT_NE(begin, std::string::npos) << ran.text;
    if (begin == std::string::npos) return nullptr;
    return Json::parse(ran.text.substr(begin, ran.text.find('\n', begin) - begin));
  }

  // Of the .glb that Blender wrote.
  Json json_of(const std::string& name) const {
    const std::string bytes = read_file(scratch_ / name);
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
      length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes.at(12 + i))) << (8 * i);
    return Json::parse(bytes.substr(20, length));
  }

  void expect_dance(const std::string& dance_file, OutScheme skeleton, OutScheme character) {
    SCOPED_TRACE(dance_file + " on " + to_string(character));
    WriteOptions options;
    options.skeleton = skeleton;
    write_clip(scratch_ / dance_file, dance_, options);
    options.skeleton = character;
    write_clip(scratch_ / "character.glb", large_body(), options);
    const Ran ran = run(at(dance_file) + " " + at("character.glb") + " --out " + at("out.glb"));
    ASSERT_EQ(ran.code, 0) << ran.text;
    const Json report = report_of(ran);
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["parts"].size(), 22u);
    EXPECT_EQ(report["frames"], dance_.frames());
    EXPECT_NEAR(report["fps"].get<double>(), dance_.fps, 1e-3);
    EXPECT_NEAR(report["scale"].get<double>(), kScale, 1e-4);
    ASSERT_EQ(report["joints"].size(), 3u);
    for (const auto& [frame, joints] : report["joints"].items()) {
      const JointPositions truth = joint_positions(dance_, std::stoi(frame));
      for (const auto& [part, place] : joints.items()) {
        // Blender's world: Z up, the dancer faces -Y.
        const Eigen::RowVector3d found(place[0].get<double>(), place[2].get<double>(),
                                       -place[1].get<double>());
        // The soles of the larger figure's mesh are no deeper than the other's.
        EXPECT_LT((found - kScale * truth.row(smpl_joint(part))).norm(), 0.02)
            << part << " frame " << frame << ": " << found;
      }
    }
    const Json out = json_of("out.glb");
    EXPECT_EQ(out["animations"].size(), 1u);
    EXPECT_EQ(out["skins"].size(), 1u);
    EXPECT_EQ(out["meshes"].size(), 1u);
    EXPECT_EQ(out["materials"].size(), 1u);
  }

  std::string blender_;
  Scratch scratch_;
  const Clip dance_ = dance();
};

TEST_F(Blender, PutsADanceOnACharacter) {
  expect_dance("dance.bvh", OutScheme::mixamo, OutScheme::unreal);
  expect_dance("dance.glb", OutScheme::smpl, OutScheme::mixamo);
}

// Blender's own exporter makes an .fbx of the figure: in centimetres, Z up, bones with axes of its
// own. It gets the dance as the .glb does from which it came.
TEST_F(Blender, ExportsCharactersThatAreTaken) {
  ::setenv("MOCAPLM_SCENE", MOCAPLM_BINARY_DIR "/mocaplm-scene", 0);
  // Blender 3.4's importer asks NumPy for a name that 1.24 has no more.
  scratch_.put("to_fbx.py", R"(
import numpy
numpy.bool = bool
import bpy, sys
source, target = sys.argv[-2:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
for action in list(bpy.data.actions):
    bpy.data.actions.remove(action)
for thing in bpy.data.objects:
    if thing.type == 'ARMATURE':
        for bone in thing.pose.bones:
            bone.matrix_basis.identity()
bpy.ops.export_scene.fbx(filepath=target, bake_anim=False, add_leaf_bones=False)
)");
  for (const OutScheme scheme : {OutScheme::mixamo, OutScheme::unreal}) {
    SCOPED_TRACE(to_string(scheme));
    WriteOptions options;
    options.skeleton = scheme;
    write_clip(scratch_ / "character.glb", large_body(), options);
    const Ran ran = run_shell("'" + blender_ + "' -b --python " + at("to_fbx.py") + " -- " +
                              at("character.glb") + " " + at("character.fbx"));
    ASSERT_TRUE(std::filesystem::exists(scratch_ / "character.fbx")) << ran.text;
    const Character character(scratch_ / "character.fbx");
    EXPECT_NEAR(character.scale(dance_), kScale, 1e-3);
    const Character same(scratch_ / "character.glb");
    const Clip back = read_clip(scratch_.put("out.glb", character.animated(dance_))),
               other = read_clips(scratch_.put("same.glb", same.animated(dance_))).front().clip;
    ASSERT_EQ(back.frames(), dance_.frames());
    for (Eigen::Index t = 0; t < back.frames(); ++t) {
      const JointPositions places = joint_positions(back, t);
      EXPECT_LT((places - joint_positions(other, t)).rowwise().norm().maxCoeff(), 1e-3) << t;
      EXPECT_LT((places - joint_positions(dance_, t)).rowwise().norm().maxCoeff(), 0.04) << t;
    }
    const Json out = json_of("out.glb");
    EXPECT_EQ(out["animations"].size(), 1u);
    EXPECT_EQ(out["skins"].size(), 1u);
    EXPECT_EQ(out["meshes"].size(), 1u);
    // The figure's colour, said once.
    const Json material = out["materials"].at(0),
               truth = json_of("character.glb")["materials"].at(0);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(material["pbrMetallicRoughness"]["baseColorFactor"].at(c).get<double>(),
                  truth["pbrMetallicRoughness"]["baseColorFactor"].at(c).get<double>(), 1e-3);
    EXPECT_FALSE(contains(out.dump(), "SpecularGlossiness"));
  }
}

TEST_F(Blender, SaysWhatIsMissing) {
  write_clip(scratch_ / "dance.glb", dance_);
  const Ran ran = run(at("none.bvh") + " " + at("dance.glb") + " --out " + at("out.glb"));
  EXPECT_EQ(ran.code, 3) << ran.text;
  EXPECT_TRUE(contains(ran.text, "no such file"));
  scratch_.put("map.json", R"({"hips": "Bip01"})");
  const Ran mapped = run(at("dance.glb") + " " + at("dance.glb") + " --out " + at("out.glb") +
                         " --map " + at("map.json"));
  EXPECT_EQ(mapped.code, 3) << mapped.text;
  EXPECT_TRUE(contains(mapped.text, "no bone \"Bip01\""));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "out.glb"));
}

}  // namespace
}  // namespace mocaplm::blender_test
