#include "emulator/sequence.h"

#include <gtest/gtest.h>

#include "emulator/helpers.h"

namespace mocaplm::sequence_test {

namespace {

TEST(Sequence, DistancesArePlainSums) {
  Random random(1);
  const PostureSequence a = random_sequence(random, 4, 9), b = random_sequence(random, 4, 9);
  double all = 0;
  for (int t = 0; t < 9; ++t) {
    double sum = 0, squares = 0;
    for (int i = 0; i < 4; ++i) {
      const double angle = std::acos(a.at(t).col(i).dot(b.at(t).col(i)));
      sum += angle;
      squares += angle * angle;
    }
    EXPECT_NEAR(posture_distance(a.at(t), b.at(t)), sum, 1e-9);
    EXPECT_NEAR(posture_geodesic_distance(a.at(t), b.at(t)), std::sqrt(squares), 1e-9);
    all += sum;
  }
  EXPECT_NEAR(sequence_distance(a, b), all / 9, 1e-9);
}

TEST(Sequence, LimbsAreOnTheirOwn) {
  Random random(3);
  const Posture y = random_posture(random, 5), z = random_posture(random, 5);
  const PostureTangent v = posture_log(y, z);
  EXPECT_LT((posture_exp(y, v) - z).norm(), 1e-12);
  const PostureTangent moved = posture_transport(v, y, z);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(v.col(i), sphere_log(y.col(i), z.col(i)));
    EXPECT_EQ(moved.col(i), sphere_transport(v.col(i), y.col(i), z.col(i)));
  }
}

TEST(Sequence, MeansAreThoseOfEachLimb) {
  Random random(4);
  std::vector<PostureSequence> sequences;
  const PostureSequence centre = random_sequence(random, 3, 6);
  for (int k = 0; k < 8; ++k) {
    PostureSequence near = centre;
    for (int t = 0; t < 6; ++t)
      for (int i = 0; i < 3; ++i)
        near.at(t).col(i) =
            sphere_exp(centre.at(t).col(i), random_tangent(random, centre.at(t).col(i), 0.3));
    sequences.push_back(near);
  }
  const PostureSequence mean = mean_sequence(sequences, 2);
  const Posture one = mean_posture(sequences), some = mean_posture(sequences, 1000);
  EXPECT_EQ(one, some);
  for (int i = 0; i < 3; ++i) {
    Eigen::Matrix3Xd at(3, 8), all(3, 48);
    for (int k = 0; k < 8; ++k)
      for (int t = 0; t < 6; ++t) {
        all.col(6 * k + t) = sequences[static_cast<std::size_t>(k)].at(t).col(i);
        if (t == 2) at.col(k) = all.col(6 * k + t);
      }
    EXPECT_LT((mean.at(2).col(i) - sphere_mean(at)).norm(), 1e-12);
    EXPECT_LT((one.col(i) - sphere_mean(all)).norm(), 1e-12);
  }
}

TEST(Sequence, TimeIsNormalisedAlongGeodesics) {
  Random random(5);
  PostureSequence two;
  two.values.resize(6, 2);
  const Posture y = random_posture(random, 2), z = random_posture(random, 2);
  two.at(0) = y;
  two.at(1) = z;
  const PostureSequence five = normalised(two, 5);
  for (int t = 0; t < 5; ++t)
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(sphere_distance(y.col(i), five.at(t).col(i)),
                  t / 4.0 * sphere_distance(y.col(i), z.col(i)), 1e-12);
      EXPECT_NEAR(sphere_distance(z.col(i), five.at(t).col(i)),
                  (4 - t) / 4.0 * sphere_distance(y.col(i), z.col(i)), 1e-12);
    }
  const PostureSequence long_one = random_sequence(random, 3, 11);
  EXPECT_LT((normalised(long_one, 11).values - long_one.values).norm(), 1e-12);
  EXPECT_LT((normalised(long_one, 6).values.col(2) - long_one.values.col(4)).norm(), 1e-12);
}

TEST(Sequence, BadInputIsNamed) {
  Random random(6);
  PostureSequence sequence = random_sequence(random, 3, 4);
  EXPECT_NO_THROW(check_sequence(sequence, in_file("x")));
  sequence.values(4, 2) = std::nan("");
  try {
    check_sequence(sequence, in_file("clip"));
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("clip: frame 2, limb 1"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(check_sequence({}, in_file("x")), DataError);
  EXPECT_THROW(normalised(random_sequence(random, 2, 1), 10), DataError);
}

}  // namespace

}  // namespace mocaplm::sequence_test
