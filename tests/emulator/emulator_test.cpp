#include "emulator/emulator.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "common/angles.h"
#include "emulator/helpers.h"
#include "emulator/representation.h"

namespace mocaplm::emulator_test {

namespace {

// Motions that differ by a few numbers: a common course, warped in space.
std::vector<PostureSequence> motions(int count, Eigen::Index limbs = 4, Eigen::Index frames = 25) {
  Random random(1);
  const PostureSequence centre = random_sequence(random, limbs, frames);
  std::vector<PostureSequence> all;
  for (int k = 0; k < count; ++k) {
    PostureSequence motion = centre;
    for (Eigen::Index i = 0; i < limbs; ++i) {
      const Eigen::Vector3d way = random_direction(random);
      const double size = 0.3 * random.normal(), phase = random.uniform(0, 6);
      for (Eigen::Index t = 0; t < frames; ++t) {
        const Eigen::Vector3d y = centre.at(t).col(i);
        const Eigen::Vector3d v =
            (way - way.dot(y) * y) * size * std::sin(static_cast<double>(t) / 6 + phase);
        motion.at(t).col(i) = sphere_exp(y, v);
      }
    }
    all.push_back(motion);
  }
  return all;
}

const char* const kSchemes[] = {"SIEM/SequentialPCA/IG",
                                "SIEM/SequentialPCA/MVG",
                                "IS-TVF/SequentialPCA/MVG",
                                "S-TVF/SequentialPCA/MVG",
                                "M-TVF/MPCA/MVG",
                                "SIEM/MPCA/Copula",
                                "IS-TVF/SequentialPCA/Mixture",
                                "SIEM/SequentialPCA/Bootstrap",
                                "SIEM/SequentialPCA/Local",
                                "IS-TVF/SpatialPCA/VAR",
                                "SIEM/SpatialPCA/VAR",
                                "PWI"};

SchemeOptions small() {
  SchemeOptions options;
  options.d1 = 4;
  options.d2 = 3;
  options.order = 2;
  return options;
}

TEST(Emulator, EverySchemeSamplesPosturesThatRepeat) {
  const auto all = motions(20);
  for (const char* name : kSchemes) {
    const auto emulator = fit_emulator(all, parse_scheme(name), small(), 2);
    EXPECT_EQ(to_string(emulator->scheme()), name);
    EXPECT_EQ(emulator->frames(), 25);
    EXPECT_EQ(emulator->limbs(), 4);
    const auto samples = emulator->sample(5, 3), again = emulator->sample(5, 3);
    ASSERT_EQ(samples.size(), 5u);
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_NO_THROW(check_sequence(samples[k], in_file(name)));
      EXPECT_EQ(samples[k].values, again[k].values) << name;
    }
    EXPECT_NE(samples[0].values, samples[1].values);
    EXPECT_NE(emulator->sample(1, 4)[0].values, samples[0].values);
    EXPECT_TRUE(std::isfinite(emulator->log_likelihood(all[0]))) << name;
  }
}

TEST(Emulator, FilesGiveTheSameEmulator) {
  const auto all = motions(12);
  for (const char* name : kSchemes) {
    const auto emulator = fit_emulator(all, parse_scheme(name), small());
    const auto again = read_emulator(parse_json(emulator->json().dump(), "x"), "x");
    EXPECT_EQ(to_string(again->scheme()), name);
    EXPECT_LT((emulator->sample(2, 1)[1].values - again->sample(2, 1)[1].values).norm(), 1e-9)
        << name;
    EXPECT_NEAR(emulator->log_likelihood(all[3]), again->log_likelihood(all[3]),
                1e-6 * std::abs(emulator->log_likelihood(all[3])) + 1e-6);
    Json broken = emulator->json();
    broken["scheme"] = "SIEM/PCA/MVG";
    EXPECT_THROW(read_emulator(broken, "x"), DataError);
    broken = emulator->json();
    broken.erase(broken.find(std::string(name) == "PWI" ? "factors" : "model"));
    EXPECT_THROW(read_emulator(broken, "x"), DataError) << name;
  }
}

TEST(Emulator, AllComponentsReconstructExactly) {
  const auto all = motions(40, 3, 10);
  SchemeOptions options;
  options.d1 = 6;
  options.d2 = 10;
  for (const char* name :
       {"SIEM/SequentialPCA/MVG", "IS-TVF/SequentialPCA/IG", "S-TVF/MPCA/IG", "M-TVF/MPCA/IG"}) {
    const auto emulator = fit_emulator(all, parse_scheme(name), options);
    EXPECT_LT(sequence_distance(all[5], emulator->reconstruct(all[5])), 1e-7) << name;
    const double few = sequence_distance(all[5], emulator->reconstruct(all[5], 3, 2));
    EXPECT_GT(few, 1e-4);
    EXPECT_THROW(emulator->reconstruct(all[5], 7, 1), UsageError);
    EXPECT_EQ(emulator->coefficients(all[5]).size(), 60);
  }
}

// Equation 7 for an independent Gaussian, from the coefficients alone.
TEST(Emulator, LogLikelihoodIsThatOfTheCoefficients) {
  const auto all = motions(30);
  const auto emulator = fit_emulator(all, parse_scheme("SIEM/SequentialPCA/IG"), small());
  Eigen::MatrixXd x(30, 12);
  for (int k = 0; k < 30; ++k)
    x.row(k) = emulator->coefficients(all[static_cast<std::size_t>(k)]).transpose();
  const Eigen::RowVectorXd mean = x.colwise().mean();
  const Eigen::RowVectorXd variance = (x.rowwise() - mean).colwise().squaredNorm() / 29;
  double sum = 0;
  for (int i = 0; i < 12; ++i)
    sum +=
        -0.5 * std::log(2 * kPi * variance[i]) - 0.5 * std::pow(x(4, i) - mean[i], 2) / variance[i];
  EXPECT_NEAR(emulator->log_likelihood(all[4]), sum, 1e-6);
  EXPECT_LT(mean.norm(), 1e-9);
}

// Equation 6: independent at each frame, with the frame's mean and covariance.
TEST(Emulator, PwiHasTheMeanAndCovarianceOfEachFrame) {
  const auto all = motions(60, 2, 5);
  SchemeOptions options;
  options.shrinkage = 0;
  const auto emulator = fit_emulator(all, parse_scheme("PWI"), options);
  const auto samples = emulator->sample(4000, 1);
  const Posture at = mean_sequence(all).at(3), before = mean_sequence(all).at(2);
  const auto covariance = [&](const std::vector<PostureSequence>& of) {
    Eigen::MatrixXd x(static_cast<Eigen::Index>(of.size()), 4);
    for (std::size_t k = 0; k < of.size(); ++k)
      x.row(static_cast<Eigen::Index>(k)) =
          tangent_coordinates(posture_log(at, of[k].at(3)), at).transpose();
    return Eigen::MatrixXd(x.transpose() * x / static_cast<double>(of.size() - 1));
  };
  EXPECT_LT((covariance(samples) - covariance(all)).norm(), 0.1 * covariance(all).norm());
  double together = 0;
  for (const auto& sample : samples)
    together += tangent_coordinates(posture_log(at, sample.at(3)), at)
                    .dot(tangent_coordinates(posture_log(before, sample.at(2)), before)) /
                4000;
  EXPECT_NEAR(together, 0, 0.05 * covariance(all).trace());
}

TEST(Emulator, BadInputIsNamed) {
  auto all = motions(6);
  const Scheme scheme = parse_scheme("SIEM/SequentialPCA/MVG");
  EXPECT_THROW(fit_emulator({all[0], all[1]}, scheme, {}), DataError);
  EXPECT_THROW(fit_emulator({all[0], all[0], all[0]}, scheme, {}), DataError);
  // Fewer motions than components: as many as there are.
  EXPECT_EQ(fit_emulator(all, scheme, {})->d2(), 5);
  EXPECT_THROW(fit_emulator({all[0], all[1], motions(1, 4, 9)[0]}, scheme, {}), UsageError);
  const auto still = motions(5, 3, 1);
  EXPECT_THROW(fit_emulator(still, scheme, {}), DataError);
  // A limb that never moves.
  for (auto& motion : all)
    for (Eigen::Index t = 0; t < motion.frames(); ++t)
      motion.at(t).col(1) = Eigen::Vector3d::UnitX();
  for (const char* name : kSchemes) {
    const auto samples = fit_emulator(all, parse_scheme(name), small())->sample(2, 1);
    if (std::string(name).find("VAR") == std::string::npos) {
      EXPECT_LT(sphere_distance(samples[0].at(9).col(1), Eigen::Vector3d::UnitX()), 1e-3) << name;
    }
  }
  all[2].values(4, 3) = std::nan("");
  EXPECT_THROW(fit_emulator(all, scheme, {}), DataError);
  EXPECT_THROW(fit_emulator(all, parse_scheme("PWI"), {}), DataError);
}

TEST(Scheme, NamesAreParsed) {
  for (const char* name : kSchemes) EXPECT_EQ(to_string(parse_scheme(name)), name);
  for (const char* name : {"SIEM", "SIEM/MVG", "SIEM/SequentialPCA/VAR", "SIEM/SpatialPCA/MVG",
                           "X/MPCA/IG", "SIEM/PCA/IG", "SIEM/MPCA/G", ""})
    EXPECT_THROW(parse_scheme(name), UsageError) << name;
  try {
    parse_scheme("SIEM/SequentialPca/MVG");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"SequentialPCA\""), std::string::npos)
        << error.what();
  }
}

}  // namespace

}  // namespace mocaplm::emulator_test
