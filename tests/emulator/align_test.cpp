#include "emulator/align.h"

#include <gtest/gtest.h>

#include "common/angles.h"
#include "emulator/helpers.h"
#include "emulator/representation.h"

namespace mocaplm::align_test {

namespace {

Eigen::MatrixXd random_field(Random& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd field(rows, columns);
  for (Eigen::Index i = 0; i < field.size(); ++i) field.data()[i] = random.normal();
  return field;
}

// The integral by a fine sum, for any warping.
double plain_cost(const Eigen::MatrixXd& fixed, const Eigen::MatrixXd& moved,
                  const Eigen::VectorXd& warping, double stiffness) {
  const Eigen::Index n = fixed.cols();
  const int fine = 840;
  double sum = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double slope = warping[j + 1] - warping[j];
    for (int k = 0; k < fine; ++k) {
      const double at = warping[j] + slope * (k + 0.5) / fine;
      const auto i = std::min(n - 1, static_cast<Eigen::Index>(at));
      sum += (fixed.col(j) - std::sqrt(slope) * moved.col(i)).squaredNorm() +
             stiffness * std::pow(std::sqrt(slope) - 1, 2);
    }
  }
  return sum / static_cast<double>(fine * n);
}

// All warpings of a small grid, one after the other.
void try_all(const Eigen::MatrixXd& fixed, const Eigen::MatrixXd& moved, Eigen::Index steepest,
             double stiffness, Eigen::Index i, Eigen::Index j, Eigen::VectorXd& warping,
             double& best) {
  const Eigen::Index n = fixed.cols();
  if (j == n) {
    if (i == n) best = std::min(best, plain_cost(fixed, moved, warping, stiffness));
    return;
  }
  for (Eigen::Index p = 1; p <= steepest && i + p <= n; ++p)
    for (Eigen::Index q = 1; q <= steepest && j + q <= n; ++q) {
      for (Eigen::Index k = 1; k <= q; ++k)
        warping[j + k] =
            static_cast<double>(i) + static_cast<double>(k * p) / static_cast<double>(q);
      try_all(fixed, moved, steepest, stiffness, i + p, j + q, warping, best);
    }
}

TEST(Warping, IsTheBestOfAll) {
  Random random(1);
  for (int k = 0; k < 8; ++k) {
    AlignOptions options;
    options.steepest = k % 2 == 0 ? 2 : 3;
    options.stiffness = k < 4 ? 0 : 1.5;
    const Eigen::MatrixXd fixed = random_field(random, 2, 5), moved = random_field(random, 2, 5);
    double cost = 0, best = 1e9;
    const Eigen::VectorXd warping = best_warping(fixed, moved, options, &cost);
    Eigen::VectorXd trial = Eigen::VectorXd::Zero(6);
    try_all(fixed, moved, options.steepest, options.stiffness, 0, 0, trial, best);
    EXPECT_NEAR(cost, best, 1e-9);
    EXPECT_NEAR(plain_cost(fixed, moved, warping, options.stiffness), best, 1e-9);
    EXPECT_EQ(warping[0], 0);
    EXPECT_EQ(warping[5], 5);
    for (int j = 0; j < 5; ++j) EXPECT_GT(warping[j + 1], warping[j]);
  }
}

TEST(Warping, NothingToAlignIsLeftAlone) {
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(4, 20);
  double cost = 1;
  const Eigen::VectorXd warping = best_warping(zero, zero, {}, &cost);
  EXPECT_LT((warping - Eigen::VectorXd::LinSpaced(21, 0, 20)).norm(), 1e-12);
  EXPECT_EQ(cost, 0);
  Random random(2);
  const Eigen::MatrixXd field = random_field(random, 4, 20);
  EXPECT_LT((best_warping(field, field, {}, &cost) - Eigen::VectorXd::LinSpaced(21, 0, 20)).norm(),
            1e-12);
  EXPECT_NEAR(cost, 0, 1e-12);
  EXPECT_THROW(best_warping(field, field.leftCols(3), {}), UsageError);
}

// h of a warped path is h(g) sqrt(g').
TEST(Field, IsThatOfTheWarpedPath) {
  Random random(3);
  const PostureSequence path = random_sequence(random, 4, 2001);
  const Posture reference = random_posture(random, 4);
  const Eigen::Index n = 2000;
  Eigen::VectorXd times(n + 1);
  for (Eigen::Index t = 0; t <= n; ++t) {
    const double x = static_cast<double>(t) / n;
    times[t] = n * (x + 0.1 * std::sin(2 * kPi * x));
  }
  const Eigen::MatrixXd h = square_root_velocity(path, reference);
  const Eigen::MatrixXd warped = square_root_velocity(read_at(path, times), reference);
  for (Eigen::Index t = 10; t < n; t += 97) {
    const double x = (static_cast<double>(t) + 0.5) / n;
    const double slope = 1 + 0.1 * 2 * kPi * std::cos(2 * kPi * x);
    const double at = n * (x + 0.1 * std::sin(2 * kPi * x));
    const Eigen::VectorXd expected = std::sqrt(slope) * h.col(static_cast<Eigen::Index>(at));
    EXPECT_LT((warped.col(t) - expected).norm(), 0.02 * expected.norm() + 0.01);
  }
  // Its squared norm is the path's length.
  double length = 0;
  for (Eigen::Index t = 0; t < n; ++t)
    length += posture_geodesic_distance(path.at(t), path.at(t + 1));
  EXPECT_NEAR(h.squaredNorm() / n, length, 1e-9);
}

// The distance does not change when both are warped alike.
TEST(Field, DistanceIsInvariant) {
  Random random(4);
  const PostureSequence a = random_sequence(random, 3, 1601), b = random_sequence(random, 3, 1601);
  const Posture reference = random_posture(random, 3);
  Eigen::VectorXd times(1601);
  for (Eigen::Index t = 0; t < 1601; ++t) {
    const double x = static_cast<double>(t) / 1600;
    times[t] = 1600 * (0.5 * x + 0.5 * x * x);
  }
  const auto distance = [&](const PostureSequence& c, const PostureSequence& d) {
    return (square_root_velocity(c, reference) - square_root_velocity(d, reference)).norm() / 40;
  };
  EXPECT_NEAR(distance(a, b), distance(read_at(a, times), read_at(b, times)),
              0.01 * distance(a, b));
}

TEST(Align, RecoversAKnownWarp) {
  Random random(5);
  for (int k = 0; k < 5; ++k) {
    const PostureSequence fixed = random_sequence(random, 6, 201);
    const double bend = 0.12 * (k - 2);
    // The other one runs through the same postures, at other times and with another length.
    Eigen::VectorXd times(321);
    for (Eigen::Index t = 0; t < 321; ++t) {
      const double x = static_cast<double>(t) / 320;
      times[t] = 200 * (x + bend * std::sin(kPi * x) * std::sin(kPi * x));
    }
    const PostureSequence other = read_at(fixed, times);
    const Posture reference = mean_posture({fixed});
    AlignOptions options;
    options.steepest = 8;
    const Alignment aligned = align_to(other, fixed, reference, options);
    // fixed(t) = other(g(t)): at g(t), `times` is t.
    for (Eigen::Index t = 0; t <= 200; t += 10) {
      const double at = aligned.warping[t] * 320;
      const double x = at / 320;
      EXPECT_NEAR(x + bend * std::sin(kPi * x) * std::sin(kPi * x), t / 200.0, 0.01);
    }
    EXPECT_LT(sequence_distance(aligned.sequence, fixed),
              0.05 + 0.25 * sequence_distance(normalised(other, 201), fixed));
    if (k == 2) {
      EXPECT_LT(aligned.amount, 0.05);
    } else {
      EXPECT_GT(aligned.amount, 0.05);
      EXPECT_LT(aligned.after, 0.5 * aligned.before);
    }
  }
}

TEST(Align, AllToOneAndToTheirMean) {
  Random random(6);
  const PostureSequence centre = random_sequence(random, 5, 151);
  std::vector<PostureSequence> sequences;
  double bends = 0;
  for (int k = 0; k < 8; ++k) {
    const double bend = 0.03 * (k - 3.5);
    bends += bend;
    Eigen::VectorXd times(100 + 10 * k);
    for (Eigen::Index t = 0; t < times.size(); ++t) {
      const double x = static_cast<double>(t) / static_cast<double>(times.size() - 1);
      times[t] = 150 * (x + bend * std::sin(2 * kPi * x));
    }
    sequences.push_back(read_at(centre, times));
  }
  EXPECT_NEAR(bends, 0, 1e-12);
  const auto spread = [](const Aligned& aligned) {
    double sum = 0;
    for (const Alignment& item : aligned.items)
      sum += sequence_distance(item.sequence, aligned.fixed);
    return sum;
  };
  AlignOptions none, one, mean;
  none.align = "none";
  one.align = "reference";
  mean.align = "mean";
  const Aligned even = align_all(sequences, 121, none);
  const Aligned to_first = align_all(sequences, 121, one, 0);
  const Aligned to_mean = align_all(sequences, 121, mean, central_sequence(sequences, 121), 2);
  EXPECT_LT(spread(to_first), 0.3 * spread(even));
  EXPECT_LT(spread(to_mean), 0.3 * spread(even));
  EXPECT_EQ(even.items[0].amount < 1e-6, true);
  Eigen::VectorXd warping = Eigen::VectorXd::Zero(121);
  for (const Alignment& item : to_mean.items) {
    EXPECT_EQ(item.sequence.frames(), 121);
    warping += item.warping / 8;
  }
  // The mean's time is in the middle of all.
  EXPECT_LT((warping - Eigen::VectorXd::LinSpaced(121, 0, 1)).cwiseAbs().maxCoeff(), 0.01);
}

TEST(Align, BadInputIsRefused) {
  Random random(7);
  const std::vector<PostureSequence> sequences = {random_sequence(random, 3, 9),
                                                  random_sequence(random, 3, 1)};
  EXPECT_THROW(align_all(sequences, 10, {}), DataError);
  EXPECT_THROW(align_all({sequences[0]}, 1, {}), UsageError);
  EXPECT_THROW(align_all({}, 10, {}), UsageError);
  EXPECT_THROW(align_all({sequences[0], random_sequence(random, 4, 9)}, 10, {}), UsageError);
  // Who stands still is aligned to anybody.
  PostureSequence still = sequences[0];
  still.values.colwise() = Eigen::VectorXd(still.values.col(0));
  const Aligned aligned = align_all({sequences[0], still}, 10, {});
  EXPECT_TRUE(aligned.items[1].sequence.values.allFinite());
}

}  // namespace

}  // namespace mocaplm::align_test
