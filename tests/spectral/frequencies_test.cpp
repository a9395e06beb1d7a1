#include "spectral/frequencies.h"

#include <gtest/gtest.h>

#include <limits>

#include "numeric/dct.h"

namespace mocaplm::frequencies_test {
namespace {

void expect_range(RowRange found, Eigen::Index first, Eigen::Index last) {
  EXPECT_EQ(found.first, first);
  EXPECT_EQ(found.last, last);
}

TEST(Frequencies, BordersBelongToTheRange) {
  expect_range(rows_within(0, 2, 0.25, 60), 0, 9);
  expect_range(rows_within(1, 2, 0.25, 60), 4, 9);
  expect_range(rows_within(1.01, 1.99, 0.25, 60), 5, 8);
  expect_range(rows_within(0, 100, 0.25, 60), 0, 60);
  expect_range(rows_within(8, std::numeric_limits<double>::infinity(), 0.25, 60), 32, 60);
  // Steps that have no binary fraction: 3 * 0.1 is more than 0.3.
  for (Eigen::Index k = 1; k < 200; ++k) {
    const double hz = static_cast<double>(k) / 10;
    expect_range(rows_within(hz, hz, 0.1, 1000), k, k + 1);
  }
}

TEST(Frequencies, EmptyRangesHaveNoRows) {
  EXPECT_LE(rows_within(0.3, 0.4, 0.25, 60).count(), 0);
  EXPECT_LE(rows_within(16, 20, 0.25, 60).count(), 0);
  EXPECT_LE(rows_within(1e300, 1e308, 1e-9, 60).count(), 0);
  EXPECT_EQ(dct_step(30, 60), 0.25);
}

TEST(Frequencies, VisitsEveryRowOnceInOrder) {
  const Eigen::Index n = 700;  // more than one piece
  const Eigen::MatrixXd all = dct_matrix(n);
  Eigen::Index next = 3;
  visit_dct_rows(n, {3, 650}, [&](Eigen::Index first, const Eigen::MatrixXd& basis) {
    ASSERT_EQ(first, next);
    EXPECT_LT((basis - all.middleRows(first, basis.rows())).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(basis.rows(), n / 2);
    next += basis.rows();
  });
  EXPECT_EQ(next, 650);
  visit_dct_rows(n, {5, 5}, [&](Eigen::Index, const Eigen::MatrixXd&) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace mocaplm::frequencies_test
