#include "emulator/evaluation/clusters.h"

#include <gtest/gtest.h>

#include <set>

#include "emulator/evaluation/random_postures.h"
#include "support/refusal.h"

namespace mocaplm::clusters_test {
namespace {

// A sequence that stays at four postures in turn, a quarter of its time at each, with some noise.
PostureSequence four_postures(Eigen::Index frames, Random& random) {
  PostureSequence sequence;
  sequence.values.resize(3 * 4, frames);
  for (Eigen::Index t = 0; t < frames; ++t)
    for (Eigen::Index limb = 0; limb < 4; ++limb) {
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      v[(limb + 4 * t / frames) % 3] = 4 * t / frames == 3 ? -1 : 1;
      v += 0.05 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      sequence.values.block<3, 1>(3 * limb, t) = v.normalized();
    }
  return sequence;
}

TEST(PostureClusters, FindsPosturesAndSaysSequencesInThem) {
  Random random(1);
  std::vector<PostureSequence> all;
  for (int i = 0; i < 6; ++i) all.push_back(four_postures(40, random));
  std::vector<const PostureSequence*> pointers;
  for (const PostureSequence& one : all) pointers.push_back(&one);
  for (const std::size_t postures : {1000u, 150u}) {
    const PostureClusters clusters = find_posture_clusters(pointers, postures, 0, 1, 2);
    ASSERT_EQ(clusters.count(), 4);
    EXPECT_EQ(clusters.postures, std::min<std::size_t>(postures, 240));
    std::size_t members = 0;
    for (const std::size_t size : clusters.sizes) members += size;
    EXPECT_EQ(members, clusters.postures);
    for (const Symbols& symbols : quantise_all(all, clusters, 2)) {
      ASSERT_EQ(symbols.size(), 40u);
      std::set<int> seen;
      for (std::size_t t = 0; t < 40; ++t) {
        EXPECT_EQ(symbols[t], symbols[t / 10 * 10]);
        seen.insert(symbols[t]);
      }
      EXPECT_EQ(seen.size(), 4u);
    }
  }
}

TEST(PostureClusters, RepeatAndBearOnePosture) {
  Random random(2);
  const PostureSequence one = four_postures(60, random);
  const PostureClusters a = find_posture_clusters({&one}, 30, 0, 5, 1),
                        b = find_posture_clusters({&one}, 30, 0, 5, 2);
  EXPECT_EQ((a.canonical.values - b.canonical.values).norm(), 0);
  PostureSequence still = one;
  still.values.conservativeResize(Eigen::NoChange, 1);
  EXPECT_EQ(find_posture_clusters({&still}, 30, 0, 5).count(), 1);
  EXPECT_TRUE(contains(refusal([] { find_posture_clusters({}, 30, 0, 5); }), "no postures"));
}

}  // namespace
}  // namespace mocaplm::clusters_test
