// Scene files from strangers: whatever is in them, an error that names the file, in time.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "motion/formats/character.h"
#include "motion/formats/fbx_text.h"
#include "motion/formats/formats.h"
#include "motion/formats/gltf_file.h"
#include "motion/formats/helpers.h"
#include "motion/formats/scene_process.h"
#include "motion/formats/scene_takes.h"
#include "motion/helpers.h"

namespace fs = std::filesystem;

namespace mocaplm::scene_hostile_test {
namespace {

class HostileScenes : public testing::Test {
 protected:
  void SetUp() override { ::setenv("MOCAPLM_SCENE", MOCAPLM_BINARY_DIR "/mocaplm-scene", 0); }

  fs::path program(const std::string& lines) {
    const fs::path path = scratch_.put("reader", "#!/bin/sh\n" + lines + "\n");
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }
  std::string answer_of(const std::string& lines, int milliseconds = 20000) {
    SceneReader reader;
    reader.program = program(lines);
    reader.patience = std::chrono::milliseconds(milliseconds);
    reader.max_answer = 1 << 20;
    return refusal([&] { read_scene(scratch_.put("walk.fbx", "x"), reader); });
  }
  void expect_refused(const fs::path& path, const std::string& why) {
    const std::string error = refusal([&] { read_clips(path); });
    EXPECT_TRUE(contains(error, path.filename()) && contains(error, why)) << error;
  }
  static MovingTree two_bones() {
    MovingTree tree = {{"a", -1, {}, {}}, {"b", 0, {{0, 1, 0}, {}, {}}, {}}};
    for (MovingNode& node : tree)
      for (int t = 0; t < 3; ++t) {
        Trs now = node.still;
        now.r = Eigen::AngleAxisd(0.1 * t, Eigen::Vector3d::UnitX());
        node.frames.push_back(now);
      }
    return tree;
  }
  static std::vector<FbxBone> two_fbx_bones() {
    FbxBone upper, lower;
    upper.name = "upper";
    lower.name = "lower";
    lower.parent = 0;
    lower.translation = {0, 20, 0};
    return {upper, lower};
  }
  static GltfFile gltf() {
    GltfFile file(two_bones());
    file.animate(two_bones(), {0, 0.1, 0.2}, "walk");
    return file;
  }

  Scratch scratch_;
};

TEST_F(HostileScenes, ReadersThatMisbehave) {
  EXPECT_TRUE(contains(answer_of("kill -SEGV $$"), "crashed"));
  EXPECT_TRUE(contains(answer_of("echo no such luck >&2; exit 3"), "walk.fbx: no such luck"));
  EXPECT_TRUE(contains(answer_of("exit 7"), "exit code 7"));
  EXPECT_TRUE(contains(answer_of("echo nonsense"), "different versions"));
  EXPECT_TRUE(contains(answer_of("cat /dev/zero"), "more than 1 MiB"));
  EXPECT_TRUE(contains(answer_of("cat /dev/zero >&2", 1000), "not done after 1 second"));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(contains(answer_of("exec sleep 60", 300), "not done after 0.3 seconds"));
  EXPECT_TRUE(contains(answer_of("exec sleep 60 >&- 2>&-", 300), "not done after 0.3 seconds"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(HostileScenes, WithoutTheReader) {
  SceneReader reader;
  reader.program = scratch_ / "nowhere";
  const std::string error = refusal([&] { read_scene(scratch_.put("walk.fbx", "x"), reader); });
  EXPECT_TRUE(contains(error, "walk.fbx") && contains(error, "mocaplm-scene")) << error;
  reader.max_file = 3;
  const std::string large = refusal([&] { read_scene(scratch_.put("w.fbx", "xxxx"), reader); });
  EXPECT_TRUE(contains(large, "w.fbx") && contains(large, "more than")) << large;
}

TEST_F(HostileScenes, TreesThatAreNone) {
  GltfFile circle = gltf();
  circle.json["nodes"][1]["children"] = Json::array({0U});
  expect_refused(scratch_.put("circle.gltf", circle.text()), "circle");
  GltfFile self = gltf();
  self.json["nodes"][1]["children"] = Json::array({1U});
  expect_refused(scratch_.put("self.gltf", self.text()), "hangs on two nodes");
  GltfFile absent = gltf();
  absent.json["nodes"][1]["children"] = Json::array({77U});
  expect_refused(scratch_.put("absent.gltf", absent.text()), "node 77");
  MovingTree deep = {{"n", -1, {}, two_bones()[0].frames}};
  for (int i = 1; i < 3000; ++i) deep.push_back({"n" + std::to_string(i), i - 1, {}, {}});
  deep.back().frames = two_bones()[0].frames;
  GltfFile far(deep);
  far.animate(deep, {0, 0.1, 0.2}, "walk");
  expect_refused(scratch_.put("deep.gltf", far.text()), "");
  expect_refused(scratch_.put("braces.gltf", std::string(1000000, '[')), "");
  expect_refused(scratch_.put("braces2.gltf", "{\"a\":" + std::string(1000000, '[')), "");
}

TEST_F(HostileScenes, NumbersThatCannotBe) {
  for (const double absurd : {1e30, 1e300, -1e30}) {
    GltfFile file = gltf();
    file.json["nodes"][1]["translation"][1] = absurd;
    file.json["animations"][0]["channels"].erase(3);  // b's own translations
    expect_refused(scratch_.put("far.gltf", file.text()), "");
  }
  for (const char* key : {"count", "byteOffset"}) {
    GltfFile file = gltf();
    file.json["accessors"][1][key] = 4000000000U;
    expect_refused(scratch_.put("huge.gltf", file.text()), "");
  }
  GltfFile whole = gltf();
  whole.json["accessors"][2]["componentType"] = 5122U;
  expect_refused(scratch_.put("short.gltf", whole.text()), "whole numbers");
  GltfFile old = gltf();
  old.json["asset"]["version"] = "1.0";
  expect_refused(scratch_.put("old.gltf", old.text()), "glTF 1.0");
}

// A buffer of its own is read from the file's folder and from nowhere else.
TEST_F(HostileScenes, OtherFiles) {
  fs::create_directory(scratch_ / "in");
  const GltfFile inside = gltf();
  const auto with_buffer = [&](const std::string& uri) {
    Json json = inside.json;
    json["buffers"] = Json::array({Json{{"byteLength", inside.bytes().size()}, {"uri", uri}}});
    return scratch_.put("in/walk.gltf", json.dump());
  };
  scratch_.put("in/numbers.bin", inside.bytes());
  scratch_.put("secret.bin", inside.bytes());
  EXPECT_EQ(scene_motions(read_scene(with_buffer("numbers.bin")), "walk.gltf").motions.size(), 1u);
  expect_refused(with_buffer("gone.bin"), "gone.bin");
  expect_refused(with_buffer("../secret.bin"), "secret.bin");
  expect_refused(with_buffer((scratch_ / "secret.bin").string()), "secret.bin");
  fs::create_symlink(scratch_ / "secret.bin", scratch_ / "in" / "link.bin");
  expect_refused(with_buffer("link.bin"), "link.bin");
}

TEST_F(HostileScenes, DamagedFigures) {
  Random random(2);
  Clip clip = random_clip(random, 10, 30, 1);
  write_clip(scratch_ / "whole.glb", clip);
  const std::string bytes = read_file(scratch_ / "whole.glb");
  for (int i = 0; i < 12; ++i)
    EXPECT_FALSE(reads_or_refuses(
        [&] { read_clips(scratch_.put("cut.glb", bytes.substr(0, random.below(bytes.size())))); },
        "cut.glb"));
  for (int i = 0; i < 25; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 4; ++k)
      damaged[random.below(i % 2 ? damaged.size() : 9000)] = static_cast<char>(random.below(256));
    reads_or_refuses([&] { read_clips(scratch_.put("damaged.glb", damaged)); }, "damaged.glb");
  }
}

TEST_F(HostileScenes, NamesThatAreNotSo) {
  expect_refused(scratch_.put("a.fbx", "glTF\2"), "looks like a binary glTF");
  expect_refused(scratch_.put("a.glb", "Kaydara FBX Binary  "), "looks like an FBX");
  expect_refused(scratch_.put("a.dae", "HIERARCHY"), "BVH");
  expect_refused(scratch_.put("b.dae", "<html></html>"), "is a web page");
  expect_refused(scratch_.put("c.fbx", "Kaydara FBX Binary  \0\x1a"), "");
  expect_refused(scratch_.put("d.gltf", "{}"), "d.gltf");
}

TEST_F(HostileScenes, CharactersThatAreNone) {
  const auto refused = [](const fs::path& file) { return refusal([&] { Character c(file); }); };
  const std::string empty = refused(scratch_.put("empty.fbx", FbxText({}, {}).text()));
  EXPECT_TRUE(contains(empty, "empty.fbx")) << empty;
  const std::string bones = refused(scratch_.put("bones.FBX", FbxText(two_fbx_bones(), {}).text()));
  EXPECT_TRUE(contains(bones, "bones.FBX") && contains(bones, "no mesh that a skeleton moves"))
      << bones;
  EXPECT_TRUE(contains(refused(scratch_.put("other.fbx", gltf().text())), "other.fbx"));
  const std::string whole = FbxText(two_fbx_bones(), {}).text();
  for (std::size_t end = 0; end < whole.size(); end += whole.size() / 7)
    EXPECT_TRUE(contains(refused(scratch_.put("cut.fbx", whole.substr(0, end))), "cut.fbx"));
}

// ---- what there is to read ----

TEST_F(HostileScenes, WithoutMotion) {
  const MovingTree tree = {{"a", -1, {}, {}}, {"b", 0, {}, {}}};
  const fs::path prop = scratch_.put("prop.gltf", GltfFile(tree).text());
  EXPECT_THROW(read_clips(prop), NoMotion);
  expect_refused(prop, "no skeleton and no animation");
  GltfFile body(tree);
  body.skin({0, 1}, places(tree, -1), Eigen::Matrix4d::Identity());
  expect_refused(scratch_.put("body.gltf", body.text()), "skeleton of 2 joints and no animation");
  MovingTree still = two_bones();
  for (MovingNode& node : still) node.frames.assign(3, node.still);
  GltfFile held(still);
  held.animate(still, {0, 0.1, 0.2}, "pose");
  expect_refused(scratch_.put("held.gltf", held.text()), "none of its 1 takes moves it");
}

TEST_F(HostileScenes, TakesAndCurves) {
  GltfFile file = gltf();
  file.animate(two_bones(), {0, 1 / 24.0, 2 / 24.0}, "run/fast", "STEP");
  MovingTree still = two_bones();
  for (MovingNode& node : still) node.frames.assign(3, node.still);
  file.animate(still, {0, 0.1, 0.2}, "pose");
  const Scene scene = read_scene(scratch_.put("takes.gltf", file.text()));
  ASSERT_EQ(scene.remarks.size(), 1u);
  EXPECT_TRUE(contains(scene.remarks[0].text, "6 in steps")) << scene.remarks[0].text;
  const SceneMotions found = scene_motions(scene, "takes.gltf");
  ASSERT_EQ(found.motions.size(), 2u);
  EXPECT_EQ(found.motions[0].name, "walk");
  EXPECT_EQ(found.motions[0].bvh.fps, 30);
  EXPECT_EQ(found.motions[1].name, "run_fast");
  EXPECT_EQ(found.motions[1].bvh.fps, 24);
  ASSERT_EQ(found.remarks.size(), 1u);
  EXPECT_TRUE(contains(found.remarks[0].text, "\"pose\"")) << found.remarks[0].text;
}

}  // namespace
}  // namespace mocaplm::scene_hostile_test
