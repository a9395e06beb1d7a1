// Rates of keys, and the bytes between mocaplm-scene and its reader.
#include "motion/formats/scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/random.h"
#include "motion/formats/scene_rate.h"
#include "motion/formats/scene_takes.h"
#include "support/refusal.h"

namespace mocaplm::scene_test {
namespace {

std::vector<double> grid(double fps, int count, double begin = 0, double rounded = 0) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const double time = begin + i / fps;
    times.push_back(rounded > 0 ? std::round(time / rounded) * rounded
                                : static_cast<double>(static_cast<float>(time)));
  }
  return times;
}

double rate(std::vector<double> times, double begin = 0) {
  return scene_rate(std::move(times), begin, true, "walk").fps;
}

TEST(SceneRate, OfKeysInEqualSteps) {
  for (const double fps : {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0, 240.0, 33.0})
    for (const int count : {3, 50, 3000}) {
      EXPECT_EQ(rate(grid(fps, count)), fps) << count;
      EXPECT_EQ(rate(grid(fps, count, 1 / fps), 1 / fps), fps) << count;  // Blender begins at 1
    }
  EXPECT_NEAR(rate(grid(30 / 1.001, 3000)), 30 / 1.001, 1e-6);
  EXPECT_NEAR(rate(grid(24 / 1.001, 3000)), 24 / 1.001, 1e-6);
  // Milliseconds, and four digits.
  EXPECT_EQ(rate(grid(30, 500, 0, 1e-3)), 30);
  EXPECT_EQ(rate(grid(60, 500, 0, 1e-4)), 60);
}

TEST(SceneRate, OfKeysThatWereThinnedOut) {
  Random random(5);
  for (const double fps : {24.0, 25.0, 30.0, 60.0, 120.0}) {
    std::vector<double> times = {0}, all = grid(fps, 400);
    for (std::size_t i = 1; i < all.size(); ++i)
      if (random.uniform() < 0.4 || i < 3) times.push_back(all[i]);
    random.shuffle(times);
    EXPECT_EQ(rate(times), fps);
  }
  EXPECT_EQ(rate({0, 0.5, 1.0}), 24);  // two keys a second: a multiple
  EXPECT_EQ(rate({0, 0.1, 0.2, 0.3}), 30);
  EXPECT_EQ(rate({0, 0.04, 1.0}), 25);
}

TEST(SceneRate, SaysWhatItGuesses) {
  const SceneRate fast = scene_rate(grid(1000, 500), 0, true, "walk");
  EXPECT_EQ(fast.fps, 240);
  ASSERT_EQ(fast.remarks.size(), 1u);
  EXPECT_TRUE(contains(fast.remarks[0].text, "1000 keys a second")) << fast.remarks[0].text;
  const SceneRate odd = scene_rate({0, 0.0123, 0.0377, 0.1, 0.1511, 0.3203}, 0, true, "walk");
  EXPECT_EQ(odd.fps, 240);
  EXPECT_EQ(odd.remarks.size(), 1u);
  EXPECT_EQ(scene_rate(grid(2, 10), 0, true, "walk").remarks.size(), 1u);
  EXPECT_EQ(scene_rate(grid(2, 10), 0, false, "walk").remarks.size(), 0u);
  EXPECT_EQ(scene_rate(grid(30, 10), 0, true, "walk").remarks.size(), 0u);
}

Scene small_scene() {
  Scene scene;
  scene.unit = 0.01;
  scene.meshes = 3;
  scene.nodes.resize(3);
  scene.nodes[0].name = "root";
  scene.nodes[1] = {"hip", 0, SceneNodeKind::plain, 2 * Eigen::Matrix4d::Identity()};
  scene.nodes[2] = {"eye", 1, SceneNodeKind::camera, Eigen::Matrix4d::Identity()};
  scene.skins.push_back({2, {{1, 3 * Eigen::Matrix4d::Identity()}}});
  SceneTake take{"walk", 0, 1, {}};
  SceneTrack track;
  track.node = 1;
  track.positions = {{0, 0.5, 1}, {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}}};
  track.rotations = {{0}, {Eigen::Quaternionf(0.5f, 0.5f, -0.5f, 0.5f)}};
  track.scales = {{0}, {Eigen::Vector3f::Ones()}};
  take.tracks.push_back(track);
  scene.takes.push_back(take);
  scene.remarks.push_back({"kind", "a remark"});
  return scene;
}

TEST(SceneBytes, ComeBack) {
  const std::string bytes = scene_bytes(small_scene());
  const Scene back = parse_scene(bytes, "walk.fbx");
  EXPECT_EQ(scene_bytes(back), bytes);
  EXPECT_EQ(back.nodes[2].kind, SceneNodeKind::camera);
  EXPECT_EQ(back.takes[0].tracks[0].positions.values[1], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(back.takes[0].tracks[0].rotations.values[0].z(), 0.5f);
  EXPECT_EQ(back.remarks[0].text, "a remark");
}

TEST(SceneBytes, ThatAreDamagedAreRefusedOrSound) {
  const std::string bytes = scene_bytes(small_scene());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(
        reads_or_refuses([&] { parse_scene(bytes.substr(0, size), "walk.fbx"); }, "walk.fbx"));
  EXPECT_FALSE(reads_or_refuses([&] { parse_scene(bytes + "x", "walk.fbx"); }, "walk.fbx"));
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k)
      damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    reads_or_refuses([&] { scene_motions(parse_scene(damaged, "walk.fbx"), "walk.fbx"); },
                     "walk.fbx");
  }
}

TEST(SceneBytes, OfNoTree) {
  const auto refused = [](const auto& change, const std::string& why) {
    Scene scene = small_scene();
    change(scene);
    const std::string bytes = scene_bytes(scene);
    const std::string error = refusal([&] { parse_scene(bytes, "walk.fbx"); });
    EXPECT_TRUE(contains(error, "walk.fbx") && contains(error, why)) << error;
  };
  refused([](Scene& s) { s.nodes[1].parent = 2; }, "parent");
  refused([](Scene& s) { s.nodes[1].parent = 1; }, "parent");
  refused([](Scene& s) { s.nodes[1].parent = -1; }, "parent");
  refused([](Scene& s) { s.nodes[1].name = "root"; }, "twice");
  refused([](Scene& s) { s.skins[0].bones[0].node = 3; }, "node");
  refused([](Scene& s) { s.takes[0].tracks[0].positions.times[1] = 2; }, "back in time");
  refused([](Scene& s) { s.nodes[1].local(1, 2) = NAN; }, "finite");
  refused([](Scene& s) { s.nodes[1].local(1, 2) = 1e30; }, "1e9");
  refused([](Scene& s) { s.unit = 0; }, "unit");
}

}  // namespace
}  // namespace mocaplm::scene_test
