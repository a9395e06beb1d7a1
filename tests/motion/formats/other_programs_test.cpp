// Files as other programs read them: the official glTF validator, Debian's assimp and numpy. Each
// test says what is not installed when it skips.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "common/find_program.h"
#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/helpers.h"
#include "motion/resample.h"
#include "motion/skeleton.h"
#include "support/glb_file.h"
#include "support/run_program.h"

namespace mocaplm::other_programs_test {
namespace {

constexpr Eigen::Index kFrames = 40;

// A figure on the ground that turns and bends, at a rate that is no whole number.
Clip moving_clip() {
  Random random(11);
  Clip keys = random_clip(random, 5, 3, 1.2);
  keys.trans.col(1).array() += 1;
  Clip clip = slice(resample(keys, 29.97), 0, kFrames);
  clip.name = "moving";
  return clip;
}

std::string shell_word(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

class OtherPrograms : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const WriteOptions& options = {}) {
    write_clip(scratch_ / name, clip_, options);
    return scratch_ / name;
  }
  Scratch scratch_;
  const Clip clip_ = moving_clip();
};

// ---- glTF validator ----

std::string validator_folder() {
  if (const char* given = std::getenv("MOCAPLM_GLTF_VALIDATOR")) return given;
  return MOCAPLM_BINARY_DIR "/npm/node_modules/gltf-validator";
}

TEST_F(OtherPrograms, GltfValidatorHasNothingToSay) {
  const std::string node = find_program("node"), validator = validator_folder();
  if (node.empty()) GTEST_SKIP() << "no node: apt-get install nodejs";
  if (!std::filesystem::exists(validator))
    GTEST_SKIP() << "no glTF validator in " << validator
                 << ": scripts/install --ci, or MOCAPLM_GLTF_VALIDATOR=/path/to/gltf-validator";
  Clip still = slice(clip_, 0, 1);
  write_clip(scratch_ / "still.glb", still);
  const auto script = scratch_.put("validate.js", R"(
    const fs = require('fs'), validator = require(process.argv[2]);
    validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[3])), {maxIssues: 50})
        .then((report) => console.log(JSON.stringify(report)));
  )");
  std::vector<std::string> files = {(scratch_ / "still.glb").string()};
  for (const std::string& skeleton : out_scheme_names()) {
    WriteOptions options;
    options.skeleton = out_scheme_of(skeleton);
    files.push_back(write(skeleton + ".glb", options).string());
  }
  files.push_back(write("moving.vrma").string());
  for (const std::string& file : files) {
    const bool vrma = file == files.back();
    const Ran ran = run_shell(node + " " + shell_word(script) + " " + shell_word(validator) + " " +
                              shell_word(file));
    ASSERT_EQ(ran.code, 0) << ran.text;
    const Json report = Json::parse(ran.text);
    Json messages = Json::array();
    for (const Json& message : report["issues"]["messages"])
      // It does not know the extension, and takes bones without a skin for nodes without a use.
      if (!vrma || (message["code"] != "UNSUPPORTED_EXTENSION" && message["code"] != "NODE_EMPTY"))
        messages.push_back(message);
    EXPECT_EQ(messages, Json::array()) << file << "\n" << report.dump(2);
    EXPECT_EQ(report["info"]["animationCount"], 1);
    EXPECT_EQ(report["info"]["hasSkins"], !vrma);
  }
}

// ---- assimp ----

// What assimp made of a file, as its own JSON; a null where there is no assimp.
Json assimp_scene(const std::filesystem::path& file) {
  const std::string assimp = find_program("assimp");
  if (assimp.empty()) return nullptr;
  const std::string out = file.string() + ".json";
  const Ran ran =
      run_shell(assimp + " export " + shell_word(file) + " " + shell_word(out) + " -fassjson");
  EXPECT_EQ(ran.code, 0) << ran.text;
  return load_json(out);
}

// World positions of the named joints at a frame, from assimp's nodes and animation channels.
class AssimpFigure {
 public:
  explicit AssimpFigure(const Json& scene) : scene_(scene), animation_(scene["animations"][0]) {}

  Float3 position(const std::string& joint, std::size_t frame) const {
    Float3 found = {NAN, NAN, NAN};
    walk(scene_["rootnode"], frame, {0, 0, 0}, {0, 0, 0, 1},
         [&](const std::string& name, const Float3& at) {
           if (name == joint) found = at;
         });
    return found;
  }
  int joints() const {  // without the ends of the bones
    int count = 0;
    walk(scene_["rootnode"], 0, {0, 0, 0}, {0, 0, 0, 1},
         [&](const std::string& name, const Float3&) { count += name.rfind("EndSite", 0) != 0; });
    return count;
  }

 private:
  using Visit = std::function<void(const std::string&, const Float3&)>;

  void walk(const Json& node, std::size_t frame, const Float3& origin, const Float4& turn,
            const Visit& visit) const {
    const Json& m = node["transformation"];  // row after row; files hold no rotation here
    Float3 moved = {m[3].get<double>(), m[7].get<double>(), m[11].get<double>()};
    Float4 local = {0, 0, 0, 1};
    for (const Json& channel : animation_["channels"])
      if (channel["name"] == node["name"]) {
        const Json& places = channel["positionkeys"];
        const Json& turns = channel["rotationkeys"];
        moved = places[std::min(frame, places.size() - 1)][1].get<Float3>();
        const Float4 wxyz = turns[std::min(frame, turns.size() - 1)][1].get<Float4>();
        local = {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
      }
    const Float3 offset = GlbFile::rotate(turn, moved);
    const Float3 at = {origin[0] + offset[0], origin[1] + offset[1], origin[2] + offset[2]};
    visit(node["name"], at);
    for (const Json& child : node.value("children", Json::array()))
      walk(child, frame, at, GlbFile::product(turn, local), visit);
  }

  const Json& scene_;
  const Json& animation_;
};

// assimp prints six digits: 0.1 mm at a metre.
void expect_same_figure(const Json& scene, const Clip& clip, double units_per_metre) {
  const AssimpFigure figure(scene);
  for (const std::size_t frame : {0, 13, 39}) {
    const JointPositions truth = joint_positions(clip, static_cast<Eigen::Index>(frame));
    for (int j = 0; j < kJoints; ++j) {
      const Float3 at = figure.position(joint_names()[static_cast<std::size_t>(j)], frame);
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(at[axis] / units_per_metre, truth(j, static_cast<Eigen::Index>(axis)), 1e-4)
            << frame << " " << joint_names()[static_cast<std::size_t>(j)];
    }
  }
}

TEST_F(OtherPrograms, AssimpReadsTheBvh) {
  for (const BvhUnit unit : {BvhUnit::centimetres, BvhUnit::metres}) {
    WriteOptions options;
    options.bvh_unit = unit;
    const Json scene = assimp_scene(write("moving.bvh", options));
    if (scene.is_null()) GTEST_SKIP() << "no assimp: apt-get install assimp-utils";
    const Json& animation = scene["animations"][0];
    EXPECT_NEAR(animation["tickspersecond"].get<double>(), 29.97, 1e-3);
    EXPECT_EQ(animation["duration"], kFrames - 1);
    ASSERT_EQ(animation["channels"].size(), static_cast<std::size_t>(kJoints));
    EXPECT_EQ(animation["channels"][0]["rotationkeys"].size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(AssimpFigure(scene).joints(), kJoints);
    expect_same_figure(scene, clip_, unit == BvhUnit::centimetres ? 100 : 1);
  }
}

TEST_F(OtherPrograms, AssimpReadsTheGlb) {
  const Json scene = assimp_scene(write("moving.glb"));
  if (scene.is_null()) GTEST_SKIP() << "no assimp: apt-get install assimp-utils";
  EXPECT_EQ(scene["meshes"][0]["bones"].size(), static_cast<std::size_t>(kJoints));
  const Json& animation = scene["animations"][0];
  // assimp counts glTF's time in milliseconds.
  EXPECT_NEAR(animation["duration"].get<double>() / animation["tickspersecond"].get<double>(),
              (kFrames - 1) / 29.97, 1e-3);
  expect_same_figure(scene, clip_, 1);
}

// ---- numpy ----

TEST_F(OtherPrograms, NumpyReadsTheNpz) {
  const std::string python = "/usr/bin/python3";
  if (run_shell(python + " -c 'import numpy'").code != 0)
    GTEST_SKIP() << "no numpy for " << python << ": apt-get install python3-numpy";
  const auto script = scratch_.put("read.py", R"(
import json, sys, numpy
file = numpy.load(sys.argv[1], allow_pickle=False)
print(json.dumps({key: {"dtype": str(file[key].dtype), "shape": list(file[key].shape),
                        "values": file[key].tolist()} for key in file.files}))
)");
  const Ran ran =
      run_shell(python + " " + shell_word(script) + " " + shell_word(write("moving.npz")));
  ASSERT_EQ(ran.code, 0) << ran.text;
  const Json arrays = Json::parse(ran.text);
  const auto expect_array = [&](const char* key, const char* dtype, const Json& shape) {
    ASSERT_TRUE(arrays.contains(key)) << key;
    EXPECT_EQ(arrays[key]["dtype"], dtype) << key;
    EXPECT_EQ(arrays[key]["shape"], shape) << key;
  };
  EXPECT_EQ(arrays.size(), 6u);
  expect_array("poses", "float64", {kFrames, 72});
  expect_array("trans", "float64", {kFrames, 3});
  expect_array("betas", "float64", Json::array({16}));
  expect_array("gender", "<U7", Json::array());
  expect_array("mocap_framerate", "float64", Json::array());
  EXPECT_EQ(arrays["gender"]["values"], "neutral");
  EXPECT_EQ(arrays["up_axis"]["values"], "y");
  EXPECT_EQ(arrays["mocap_framerate"]["values"], 29.97);
  // Bit for bit: Python prints the shortest digits that mean the same number.
  for (Eigen::Index t = 0; t < kFrames; ++t) {
    const auto row = static_cast<std::size_t>(t);
    for (Eigen::Index c = 0; c < 72; ++c)
      ASSERT_EQ(arrays["poses"]["values"][row][static_cast<std::size_t>(c)].get<double>(),
                clip_.poses(t, c));
    for (Eigen::Index c = 0; c < 3; ++c)
      ASSERT_EQ(arrays["trans"]["values"][row][static_cast<std::size_t>(c)].get<double>(),
                clip_.trans(t, c));
  }
}

}  // namespace
}  // namespace mocaplm::other_programs_test
