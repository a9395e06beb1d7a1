#include "emulator/evaluation/scheme_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "emulator/evaluation/random_postures.h"
#include "emulator/evaluation/reconstruction.h"
#include "emulator/evaluation/two_level.h"

namespace mocaplm::scheme_test_test {
namespace {

SchemeTestOptions quick() {
  SchemeTestOptions options;
  options.scheme.d1 = 6;
  options.scheme.d2 = 4;
  options.energy.permutations = 199;
  options.samples = 40;
  options.threads = 2;
  return options;
}

TEST(Distances, AreJoinedAndAveraged) {
  Eigen::MatrixXd a(2, 2), b(1, 1), c(2, 1);
  a << 0, 3, 3, 0;
  b << 0;
  c << 1, 2;
  Eigen::MatrixXd joined(3, 3);
  joined << 0, 3, 1, 3, 0, 2, 1, 2, 0;
  EXPECT_EQ((joined_distances(a, b, c) - joined).norm(), 0);
  EXPECT_NEAR(mean_pair(joined), 2, 1e-12);
  EXPECT_EQ(mean_pair(b), 0);
  EXPECT_NEAR(median_nearest(joined, true), 1, 1e-12);
  EXPECT_EQ(median_nearest(joined), 0);
}

TEST(Quantised, OfTheFitItselfHasNoDifference) {
  const std::vector<Symbols> fit = {{0, 0, 1, 1}, {0, 1, 1, 1}};
  const QuantisedResult same = test_quantised(fit, fit, {0, 0, 1, 1}, 2, {2, 1});
  EXPECT_EQ(same.transitions, 0);
  EXPECT_EQ(same.windows, 2u);
  EXPECT_NEAR(same.variability.mean, 0.125, 1e-12);
  EXPECT_GT(same.baseline, 0);
}

// Motions that are Gaussian in the tangent space: the Gaussian model must pass, a model without
// correlation in time is rough.
TEST(TestScheme, TellsTheRightModelFromAWrongOne) {
  const ClassMotions motions("class", random_motions(40, 6, 20, 1), random_motions(30, 6, 20, 2),
                             2);
  const SchemeResult mvg = test_scheme(motions, parse_scheme("SIEM/SequentialPCA/MVG"), quick());
  EXPECT_GT(mvg.unseen.p, 0.02);
  EXPECT_NEAR(mvg.spread, 1, 0.35);
  EXPECT_NEAR(mvg.roughness, 1, 0.3);
  EXPECT_GT(mvg.normal_median, 0.95);
  EXPECT_EQ(mvg.diverged, 0u);
  EXPECT_EQ(mvg.likelihood_samples.size(), 40u);
  EXPECT_EQ(mvg.likelihood_test.size(), 30u);
  EXPECT_EQ(mvg.to_fit.rows(), 40);
  EXPECT_EQ(mvg.to_fit.cols(), 40);
  const SchemeResult pwi = test_scheme(motions, parse_scheme("PWI"), quick());
  // The distance is a mean over time, so the two-sample test knows each moment's distribution
  // alone; that the moments do not belong together is told by roughness and the way to the nearest
  // clip.
  EXPECT_GT(pwi.unseen.p, 0.02);
  EXPECT_GT(pwi.nearest, 2);
  EXPECT_GT(pwi.roughness, 2);
  // The same seed gives the same result.
  const SchemeResult again = test_scheme(motions, parse_scheme("SIEM/SequentialPCA/MVG"), quick());
  EXPECT_EQ(again.unseen.p, mvg.unseen.p);
  EXPECT_EQ(again.likelihood_gap, mvg.likelihood_gap);
}

// Two kinds of motion far apart: one Gaussian fills what is between them, and is found out.
TEST(TestScheme, FindsAGaussianOutThatCoversTwoClusters) {
  Random random(3);
  std::vector<PostureSequence> fit, test;
  for (int i = 0; i < 200; ++i)
    (i < 100 ? fit : test).push_back(random_motion(6, 16, random, 0.05, i % 2 == 0 ? 0.5 : -0.5));
  const ClassMotions motions("class", fit, test, 2);
  SchemeTestOptions options = quick();
  options.samples = 100;
  const SchemeResult mvg = test_scheme(motions, parse_scheme("SIEM/SequentialPCA/MVG"), options);
  EXPECT_LT(mvg.unseen.p, 0.05);
  EXPECT_GT(mvg.nearest, 1.5) << "simulated motions lie where no clip is";
  EXPECT_LT(mvg.normal_least, 0.93);
}

// Fewer clips than components, and a limb that never moves: every scheme still gives numbers.
TEST(TestScheme, BearsFewClipsAndConstantLimbs) {
  std::vector<PostureSequence> fit = random_motions(5, 4, 14, 8),
                               test = random_motions(3, 4, 14, 9);
  for (auto* all : {&fit, &test})
    for (PostureSequence& one : *all)
      one.values.middleRows<3>(6).colwise() = Eigen::Vector3d::UnitX();
  const ClassMotions motions("class", fit, test, 2);
  SchemeTestOptions options = quick();
  options.scheme.d1 = options.scheme.d2 = 50;
  options.scheme.order = 2;
  options.samples = 6;
  for (const char* name :
       {"SIEM/SequentialPCA/MVG", "IS-TVF/SequentialPCA/IG", "SIEM/SequentialPCA/Local",
        "SIEM/SequentialPCA/Copula", "SIEM/MPCA/IG", "SIEM/SpatialPCA/VAR", "PWI"}) {
    const SchemeResult result = test_scheme(motions, parse_scheme(name), options);
    EXPECT_LE(result.d1, 8) << name;
    EXPECT_LE(result.d2, 14) << name;
    EXPECT_GT(result.unseen.p, 0) << name;
    EXPECT_TRUE(std::isfinite(result.spread) && std::isfinite(result.nearest)) << name;
    for (const double likelihood : result.likelihood_test)
      EXPECT_TRUE(std::isfinite(likelihood)) << name;
  }
}

TEST(Reconstruction, ErrorFallsWithComponents) {
  const ClassMotions motions("class", random_motions(20, 6, 20, 5), random_motions(10, 6, 20, 6),
                             2);
  const ReconstructionCurve curve = reconstruction_curve(
      motions, parse_scheme("SIEM/SequentialPCA/IG"), quick(), {1, 3, 6}, {1, 3, 9});
  ASSERT_EQ(curve.points.size(), 9u);
  const auto error = [&](std::size_t d1, std::size_t d2) { return curve.points[3 * d1 + d2].fit; };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE(error(0, i), error(1, i));
    EXPECT_GE(error(1, i), error(2, i));
    EXPECT_GE(error(i, 0), error(i, 1) - 1e-9);
  }
  EXPECT_LT(error(2, 2), 0.1 * error(0, 0));
}

TEST(TwoLevels, AGaussianFindsItselfAgain) {
  TwoLevelOptions two_level;
  two_level.level_one = {"SIEM/SequentialPCA/IG"};
  two_level.sequences = 160;
  two_level.test = 50;
  const std::vector<TwoLevelResult> results =
      two_level_simulation("class", random_motions(30, 6, 16, 7), two_level, quick());
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(results[0].level_two, "SIEM/SequentialPCA/IG");
  EXPECT_EQ(results[1].level_two, "SIEM/SequentialPCA/MVG");
  EXPECT_EQ(results[2].level_two, "PWI");
  EXPECT_GT(results[0].test.p, 0.02);
  EXPECT_GT(results[1].test.p, 0.02);
  EXPECT_GT(results[2].likelihood_gap, results[0].likelihood_gap);
}

}  // namespace
}  // namespace mocaplm::scheme_test_test
