// A clip on figures of other people: rigs with axes, scales and units of their own, VRM's bones,
// damaged files.
#include "motion/formats/character.h"

#include <gtest/gtest.h>

#include <functional>

#include "motion/formats/formats.h"
#include "motion/formats/glb.h"
#include "motion/formats/glb_file.h"
#include "motion/formats/helpers.h"
#include "motion/formats/skeleton_trees.h"
#include "motion/formats/skeletons.h"
#include "support/glb_file.h"

namespace mocaplm::character_test {
namespace {

constexpr double kScale = 1.3;

Clip large_body() {
  Random random(40);
  Clip clip = random_clip(random, 1, 30);
  BodyShape body;
  body.rest = kScale * rest_joints();
  clip.body = std::make_shared<const BodyShape>(body);
  return clip;
}

Clip dance() {
  Random random(41);
  Clip clip = random_clip(random, 4, 25);
  clip.name = "dance";
  return clip;
}

Json xyz(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Json xyzw(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

// A rig as exporters leave them: under a node that is turned, moved and in centimetres, every bone
// with axes of its own. The joints lie as those of `scheme` do for the large body.
Json rig(OutScheme scheme, std::uint64_t seed) {
  Random random(seed);
  const OutSkeleton skeleton = out_skeleton(large_body(), scheme);
  const auto any_turn = [&] {
    return Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, 3), random_direction(random)));
  };
  const Eigen::Quaterniond up(Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitX()));
  const Eigen::Vector3d moved(0.3, 0, -0.2);
  Json nodes = Json::array(), joints = Json::array();
  nodes.push_back({{"name", "Armature"},
                   {"translation", xyz(moved)},
                   {"rotation", xyzw(up)},
                   {"scale", {0.01, 0.01, 0.01}},
                   {"children", {1}}});
  std::vector<Eigen::Affine3d> world = {Eigen::Translation3d(moved) * up * Eigen::Scaling(0.01)};
  std::vector<Eigen::Quaterniond> turns = {up};
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const OutJoint& joint = skeleton.joints[i];
    const auto parent = static_cast<std::size_t>(joint.parent + 1);
    const Eigen::Vector3d place = joint.rest + Eigen::Vector3d(0, skeleton.lift, 0);
    turns.push_back(any_turn());
    world.push_back(Eigen::Translation3d(place) * turns.back() * Eigen::Scaling(0.01));
    const Eigen::Affine3d local = world[parent].inverse() * world.back();
    Json node = {{"name", joint.name}};
    if (i % 3 == 0) {
      Json matrix = Json::array();
      for (int k = 0; k < 16; ++k) matrix.push_back(local.matrix().data()[k]);
      node["matrix"] = matrix;
    } else {
      node["translation"] = xyz(local.translation());
      node["rotation"] = xyzw(turns[parent].conjugate() * turns.back());
    }
    Json children = Json::array();
    for (std::size_t k = i + 1; k < skeleton.joints.size(); ++k)
      if (skeleton.joints[k].parent == static_cast<int>(i)) children.push_back(k + 1);
    if (!children.empty()) node["children"] = children;
    nodes.push_back(node);
    joints.push_back(i + 1);
  }
  Json document;
  document["asset"] = {{"version", "2.0"}, {"copyright", "somebody"}};
  document["scene"] = 0;
  document["scenes"] = Json::array({Json{{"nodes", {0}}}});
  document["nodes"] = nodes;
  document["skins"] = Json::array({Json{{"joints", joints}}});
  document["extras"] = {{"of", "the rig"}};
  return document;
}

std::string bytes_of(Json document) {
  GlbBuffer buffer;
  buffer.add(std::vector<std::uint8_t>{1, 2, 3, 4, 5}, 1, kUint8);
  document["accessors"] = buffer.accessors();
  document["bufferViews"] = buffer.views();
  document["buffers"] = Json::array({Json{{"byteLength", buffer.bytes().size()}}});
  return glb_file(document, buffer.bytes());
}

// World places of all nodes in a frame of the first animation, by the specification.
std::vector<Eigen::Vector3d> places(const GlbFile& file, std::size_t frame) {
  Json nodes = file.json["nodes"];
  const Json& animation = file.json["animations"][0];
  for (const Json& channel : animation["channels"]) {
    const std::string path = channel["target"]["path"];
    const std::size_t width = path == "rotation" ? 4 : 3;
    const auto values = file.numbers(
        animation["samplers"][channel["sampler"].get<std::size_t>()]["output"].get<std::size_t>());
    Json& node = nodes[channel["target"]["node"].get<std::size_t>()];
    EXPECT_FALSE(node.contains("matrix"));
    node[path] = std::vector<double>(values.begin() + static_cast<long>(width * frame),
                                     values.begin() + static_cast<long>(width * (frame + 1)));
  }
  std::vector<Eigen::Vector3d> found(nodes.size());
  const std::function<void(std::size_t, const Eigen::Affine3d&)> walk =
      [&](std::size_t index, const Eigen::Affine3d& above) {
        const Json& node = nodes[index];
        Eigen::Affine3d local = Eigen::Affine3d::Identity();
        if (node.contains("matrix")) {
          for (std::size_t k = 0; k < 16; ++k) local.matrix().data()[k] = node["matrix"][k];
        } else {
          const auto t = node.value("translation", std::vector<double>{0, 0, 0});
          const auto r = node.value("rotation", std::vector<double>{0, 0, 0, 1});
          const auto s = node.value("scale", std::vector<double>{1, 1, 1});
          local = Eigen::Translation3d(t[0], t[1], t[2]) *
                  Eigen::Quaterniond(r[3], r[0], r[1], r[2]) * Eigen::Scaling(s[0], s[1], s[2]);
        }
        const Eigen::Affine3d world = above * local;
        found[index] = world.translation();
        for (const Json& child : node.value("children", Json::array()))
          walk(child.get<std::size_t>(), world);
      };
  walk(0, Eigen::Affine3d::Identity());
  return found;
}

class CharacterFile : public testing::Test {
 protected:
  std::filesystem::path put(const Json& document) const {
    return scratch_.put("rig.glb", bytes_of(document));
  }

  // Every joint of the rig, so many times as far from the origin as the dance has it; the soles of
  // the large body are no deeper than the other's: 1 cm.
  void expect_dance(const Character& character, const Json& rig_nodes,
                    const std::vector<Named>& names) const {
    const GlbFile file(character.animated(dance_));
    EXPECT_NEAR(character.scale(dance_), kScale, 1e-6);
    std::map<std::string, std::size_t> index;
    for (std::size_t i = 0; i < rig_nodes.size(); ++i) index[rig_nodes[i]["name"]] = i;
    for (Eigen::Index t = 0; t < dance_.frames(); ++t) {
      const auto found = places(file, static_cast<std::size_t>(t));
      const JointPositions truth = joint_positions(dance_, t);
      for (const Named& named : names) {
        if (named.smpl < 0 || named.smpl >= 22) continue;
        const Eigen::Vector3d wanted = kScale * truth.row(named.smpl).transpose();
        const Eigen::Vector3d place = found[index.at(named.name)];
        EXPECT_NEAR(place.x(), wanted.x(), 1e-4) << named.name << " " << t;
        EXPECT_NEAR(place.z(), wanted.z(), 1e-4) << named.name << " " << t;
        EXPECT_NEAR(place.y(), wanted.y() - 0.3 * 0.034, 1e-3) << named.name << " " << t;
      }
    }
  }

  Scratch scratch_;
  const Clip dance_ = dance();
};

TEST_F(CharacterFile, MovesARigWithAxesAndUnitsOfItsOwn) {
  for (const std::string scheme : {"mixamo", "cmu"}) {
    const Json document = rig(out_scheme_of(scheme), 50);
    const Character character(put(document));
    for (const auto& [joint, bone] : character.bones())
      for (const Named& named : parsed(trees().at(scheme)))
        if (named.smpl == joint_index(joint) && named.smpl < 22) {
          EXPECT_EQ(bone, named.name) << joint;
        }
    expect_dance(character, document["nodes"], parsed(trees().at(scheme)));
  }
}

// Unreal's A-pose is laid as SMPL's arms lie, whatever the bones are called.
TEST_F(CharacterFile, TakesWhatVrmSaysOfTheBones) {
  for (const bool old : {false, true}) {
    Json document = rig(OutScheme::unreal, 51);
    const std::vector<Named> unreal = parsed(trees().at("unreal"));
    std::vector<Named> named;
    Json bones = old ? Json::array() : Json::object();
    for (std::size_t i = 0; i < unreal.size(); ++i) {
      const std::string name = "bone" + std::to_string(i);
      document["nodes"][i + 1]["name"] = name;
      named.push_back({name, "", unreal[i].smpl});
      for (const Named& vrm : parsed(trees().at("vrm"))) {
        if (vrm.smpl != unreal[i].smpl || vrm.smpl < 0) continue;
        if (old)
          bones.push_back({{"bone", vrm.name}, {"node", i + 1}});
        else
          bones[vrm.name] = {{"node", i + 1}};
      }
    }
    document["extensions"][old ? "VRM" : "VRMC_vrm"]["humanoid"]["humanBones"] = bones;
    expect_dance(Character(put(document)), document["nodes"], named);
  }
}

TEST_F(CharacterFile, LeavesEverythingElseAsItWas) {
  Json document = rig(OutScheme::mixamo, 52);
  document["animations"] = Json::array({Json{{"name", "idle"}}});
  const std::string before = bytes_of(document);
  const GlbFile after(Character(scratch_.put("rig.glb", before)).animated(dance_));
  const Json was = GlbFile(before).json;
  for (const char* key : {"asset", "scene", "scenes", "skins", "extras"})
    EXPECT_EQ(after.json[key], was[key]) << key;
  ASSERT_EQ(after.json["animations"].size(), 2u);
  EXPECT_EQ(after.json["animations"][0]["name"], "dance");
  EXPECT_EQ(after.json["animations"][0]["extras"]["fps"], 25);
  EXPECT_EQ(after.json["animations"][1], was["animations"][0]);
  for (const char* key : {"accessors", "bufferViews"})
    for (std::size_t i = 0; i < was[key].size(); ++i) EXPECT_EQ(after.json[key][i], was[key][i]);
  EXPECT_EQ(after.numbers(0), GlbFile(before).numbers(0));
}

// This program's own figure, with its mesh.
TEST_F(CharacterFile, MovesOurOwnFigure) {
  WriteOptions options;
  options.skeleton = OutScheme::mixamo;
  write_clip(scratch_ / "figure.glb", large_body(), options);
  options.skeleton = OutScheme::smpl;
  options.character = std::make_shared<const Character>(scratch_ / "figure.glb");
  write_clip(scratch_ / "out.glb", dance_, options);
  const GlbFile file(read_file(scratch_ / "out.glb"));
  EXPECT_EQ(file.json["animations"].size(), 2u);
  EXPECT_EQ(file.json["meshes"].size(), 1u);
  const auto refused = [&](const char* name) {
    return refusal<UsageError>([&] { check_written_format(name, options); });
  };
  EXPECT_TRUE(contains(refused("x.bvh"), ".glb"));
  options.skeleton = OutScheme::cmu;
  EXPECT_TRUE(contains(refused("x.glb"), "skeleton"));
}

TEST_F(CharacterFile, RefusesWhatItCannotMove) {
  const auto refused = [&](const Json& document) {
    return refusal([&] { Character character(put(document)); });
  };
  Json unknown = rig(OutScheme::mixamo, 53);
  for (std::size_t i = 1; i < unknown["nodes"].size(); ++i)
    unknown["nodes"][i]["name"] = "n" + std::to_string(i);
  for (Json& node : unknown["nodes"]) {  // nor do lengths tell what is what
    node.erase("matrix");
    node["translation"] = {0, 0, 0};
  }
  EXPECT_FALSE(refused(unknown).empty());
  Json lying = rig(OutScheme::mixamo, 54);
  lying["nodes"][0].erase("rotation");
  lying["nodes"][4]["rotation"] = {0.5, 0.5, 0.5, 0.5};
  lying["nodes"][4].erase("matrix");
  EXPECT_FALSE(refused(lying).empty());
  Json bent = rig(OutScheme::mixamo, 55);
  bent["nodes"][0]["scale"] = {0.01, 0.0101, 0.01};
  EXPECT_TRUE(contains(refused(bent), "Armature"));
  Json loop = rig(OutScheme::mixamo, 56);
  loop["nodes"][3]["children"] = {2};
  EXPECT_FALSE(refused(loop).empty());
  Json outside = rig(OutScheme::mixamo, 57);
  outside["nodes"][3]["children"] = {4000000000u};
  EXPECT_TRUE(contains(refused(outside), "no node"));
  EXPECT_TRUE(contains(refusal([&] { Character c(scratch_.put("x.glb", "HIERARCHY")); }), "glTF"));
  EXPECT_TRUE(contains(refusal([&] { Character c(scratch_ / "none.glb"); }), "none.glb"));
}

TEST_F(CharacterFile, DamageIsRefusedOrRead) {
  const std::string whole = bytes_of(rig(OutScheme::mixamo, 58));
  Random random(59);
  const auto reads = [&](const std::string& bytes) {
    const auto file = scratch_.put("damaged.glb", bytes);
    return reads_or_refuses([&] { Character(file).animated(dance_); }, "damaged.glb");
  };
  EXPECT_TRUE(reads(whole));
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(reads(whole.substr(0, random.below(whole.size() - 8))));
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 3; ++k)
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    reads(bytes);
  }
  // The same with sound JSON and senseless numbers in it.
  const Json document = rig(OutScheme::mixamo, 60);
  for (int i = 0; i < 300; ++i) {
    Json damaged = document;
    Json& node = damaged["nodes"][random.below(damaged["nodes"].size())];
    const char* keys[] = {"translation", "rotation", "scale", "children", "matrix", "name"};
    const Json values[] = {nullptr,        Json::array(),       {1, 2},      {0, 0, 0, 0}, "x",
                           {1e300, 1, 1},  {-1, 2, 3},          {0, 0, 0},   {1, 1, 1, 1}, -5,
                           Json::object(), {1e-300, 1e-300, 0}, {5, 6, 7, 8}};
    node[keys[random.below(6)]] = values[random.below(std::size(values))];
    const auto file = scratch_.put("damaged.glb", bytes_of(damaged));
    reads_or_refuses([&] { Character(file).animated(dance_); }, "damaged.glb");
  }
}

}  // namespace
}  // namespace mocaplm::character_test
