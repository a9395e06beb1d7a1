#include "numeric/symbols.h"

#include <gtest/gtest.h>

#include "common/random.h"

namespace mocaplm::symbols_test {
namespace {

TEST(Symbols, DisagreementAndItsSpread) {
  EXPECT_EQ(disagreement({0, 1, 2, 2}, {0, 1, 1, 2}), 0.25);
  const Variability v = variability({{0, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 1}}, {0, 0, 0, 0});
  EXPECT_NEAR(v.mean, 0.5, 1e-12);
  EXPECT_NEAR(v.variance, 0.25, 1e-12);
  EXPECT_EQ(variability({{1, 0}}, {0, 0}).variance, 0);
}

TEST(Symbols, TransitionsAreCountedInWindows) {
  // Windows of 2 steps, one after the other: 0->0, 0->1 | 1->1, 1->0 in the first sequence.
  const std::vector<Symbols> sequences = {{0, 0, 1, 1, 0}, {0, 1, 1, 2, 2}};
  const auto matrices = transition_matrices(sequences, 3, 2, 2);
  ASSERT_EQ(matrices.size(), 2u);
  Eigen::Matrix3d first, second;
  first << 1. / 3, 2. / 3, 0, 0, 1, 0, 0, 0, 0;
  second << 0, 0, 0, 1. / 3, 1. / 3, 1. / 3, 0, 0, 1;
  EXPECT_LT((matrices[0] - first).norm(), 1e-12);
  EXPECT_LT((matrices[1] - second).norm(), 1e-12);
}

// 301 frames, windows of 20, a step of 10: the paper's 29 matrices.
TEST(Symbols, HasThePapersNumberOfWindows) {
  Random random(1);
  Symbols sequence(301);
  for (int& symbol : sequence) symbol = int(random.below(9));
  const auto matrices = transition_matrices({sequence}, 9, 20, 10);
  EXPECT_EQ(matrices.size(), 29u);
  for (const auto& matrix : matrices)
    for (Eigen::Index i = 0; i < 9; ++i) {
      const double sum = matrix.row(i).sum();
      EXPECT_TRUE(sum == 0 || std::abs(sum - 1) < 1e-12);
    }
}

TEST(Symbols, UniformWalkIsTheBaseline) {
  const std::vector<Symbols> still = {Symbols(31, 2)};
  const auto p = transition_matrices(still, 4, 10, 10);
  ASSERT_EQ(p.size(), 3u);
  // A window: three rows of zeros differ by 1 each, the row of symbol 2 by 3/4 + 3 * 1/4.
  EXPECT_NEAR(transition_difference(p, uniform_transitions(3, 4)), 3 * (3 + 1.5), 1e-12);
  EXPECT_EQ(transition_difference(p, p), 0);
}

TEST(Symbols, ShortSequencesHaveOneWindowOrNone) {
  EXPECT_EQ(transition_matrices({{0, 1, 0}}, 2, 20, 10).size(), 1u);
  EXPECT_EQ(transition_matrices({{0}}, 2, 20, 10).size(), 0u);
}

}  // namespace
}  // namespace mocaplm::symbols_test
