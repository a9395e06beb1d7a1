#include "emulator/distances.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "common/angles.h"
#include "common/random.h"
#include "emulator/angles.h"
#include "support/refusal.h"

namespace mocaplm::distances_test {
namespace {

// Random unit directions; some nearly alike or opposite to the last frame's.
PostureSequence random_sequence(Eigen::Index limbs, Eigen::Index frames, std::uint64_t seed) {
  Random random(seed);
  PostureSequence sequence;
  sequence.values.resize(3 * limbs, frames);
  for (Eigen::Index t = 0; t < frames; ++t)
    for (Eigen::Index i = 0; i < limbs; ++i) {
      Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
      if (t > 0 && i % 3 == 1)
        v = sequence.values.block<3, 1>(3 * i, t - 1) + std::pow(10, -double(t % 9)) * v;
      if (t > 0 && i % 3 == 2)
        v = -sequence.values.block<3, 1>(3 * i, t - 1) + std::pow(10, -double(t % 9)) * v;
      sequence.values.block<3, 1>(3 * i, t) = v.normalized();
    }
  return sequence;
}

// Kahan's formula in long double: exact everywhere.
double angle(const double* a, const double* b) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  const Vector p(a[0], a[1], a[2]), q(b[0], b[1], b[2]);
  return double(2 * std::atan2((p - q).norm(), (p + q).norm()));
}

TEST(Angles, EveryKernelIsExactFromNearToOpposite) {
  Random random(1);
  for (const AngleKernel& kernel : angle_kernels())
    for (const double size : {0.0, 1e-12, 1e-8, 1e-4, 0.1, 1.0, kPi / 2, 3.0, kPi - 1e-8, kPi}) {
      double a[24], b[24], expected = 0;
      for (int i = 0; i < 8; ++i) {
        Eigen::Vector3d p(random.normal(), random.normal(), random.normal());
        p.normalize();
        const Eigen::Vector3d side = p.unitOrthogonal();
        const Eigen::Vector3d q = (std::cos(size) * p + std::sin(size) * side).normalized();
        for (int axis = 0; axis < 3; ++axis) {
          a[8 * axis + i] = p[axis];
          b[8 * axis + i] = q[axis];
        }
        expected += angle(p.data(), q.data());
      }
      EXPECT_NEAR(kernel.sum(a, b, 1), expected, 3e-12) << kernel.name << " " << size;
    }
}

TEST(SequenceDistances, AreThePlainLoops) {
  // 5 limbs, 7 frames: 35 vectors do not fill whole blocks.
  std::vector<PostureSequence> all;
  for (std::uint64_t i = 0; i < 9; ++i) all.push_back(random_sequence(5, 7, 10 + i));
  const Eigen::MatrixXd d = sequence_distances(all, 2);
  const Eigen::MatrixXd cross = cross_distances({all[0], all[1]}, {all[2], all[3], all[4]}, 2);
  ASSERT_EQ(d.rows(), 9);
  for (Eigen::Index i = 0; i < 9; ++i)
    for (Eigen::Index j = 0; j < 9; ++j) {
      double sum = 0;
      for (Eigen::Index k = 0; k < 35; ++k)
        sum += angle(all[std::size_t(i)].values.data() + 3 * k,
                     all[std::size_t(j)].values.data() + 3 * k);
      EXPECT_NEAR(d(i, j), sum / 7, 1e-11);
      if (i < 2 && j >= 2 && j < 5) {
        EXPECT_NEAR(cross(i, j - 2), sum / 7, 1e-11);
      }
    }
  EXPECT_EQ((d - d.transpose()).norm(), 0);
  EXPECT_EQ(d.diagonal().norm(), 0);
}

TEST(PostureDistances, AreThoseOfSingleFrames) {
  const std::vector<PostureSequence> all = {random_sequence(6, 70, 3), random_sequence(6, 61, 4)};
  const Eigen::MatrixXf d = posture_distances(PackedPostures::of_frames(all), 2);
  ASSERT_EQ(d.rows(), 131);
  for (const auto& [i, j] : {std::pair<int, int>{0, 1}, {5, 69}, {69, 70}, {130, 2}, {100, 101}}) {
    const auto frame = [&](int k) {
      return k < 70 ? all[0].values.col(k).data() : all[1].values.col(k - 70).data();
    };
    double sum = 0;
    for (int limb = 0; limb < 6; ++limb) sum += angle(frame(i) + 3 * limb, frame(j) + 3 * limb);
    EXPECT_NEAR(d(i, j), sum, 1e-5);
    EXPECT_EQ(d(i, j), d(j, i));
  }
}

TEST(Steps, AreTheDistancesFromFrameToFrame) {
  const PostureSequence s = random_sequence(4, 12, 5);
  const Eigen::VectorXd steps = steps_of(s);
  ASSERT_EQ(steps.size(), 11);
  for (Eigen::Index t = 0; t < 11; ++t) {
    double sum = 0;
    for (int limb = 0; limb < 4; ++limb)
      sum += angle(s.values.col(t).data() + 3 * limb, s.values.col(t + 1).data() + 3 * limb);
    EXPECT_NEAR(steps[t], sum, 1e-11);
  }
  const PostureSequence other = random_sequence(4, 12, 6);
  EXPECT_LT((mean_steps({s, other}) - (steps + steps_of(other)) / 2).norm(), 1e-12);
  EXPECT_EQ(steps_of(random_sequence(4, 1, 7)).size(), 0);
}

TEST(SequenceDistances, RefuseWhatDoesNotGoTogether) {
  PostureSequence bad = random_sequence(3, 4, 1);
  bad.values(2, 2) = std::nan("");
  const PostureSequence good = random_sequence(3, 4, 2);
  EXPECT_TRUE(contains(refusal([&] { sequence_distances({good, bad}); }), "sequence 2"));
  EXPECT_TRUE(contains(refusal([&] {
                         sequence_distances({good, random_sequence(3, 5, 1)});
                       }),
                       "5 frames"));
  EXPECT_TRUE(contains(refusal([&] { cross_distances({good}, {random_sequence(2, 4, 1)}); }),
                       "same frames"));
}

}  // namespace
}  // namespace mocaplm::distances_test
