// One scheme, fitted to clips of one class and tested against unseen others of it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "emulator/distances.h"
#include "emulator/emulator.h"
#include "emulator/evaluation/clusters.h"
#include "numeric/energy.h"
#include "numeric/symbols.h"

namespace mocaplm {

// Aligned sequences of one class, all of T frames, and what all schemes need of them.
class ClassMotions {
 public:
  ClassMotions(std::string name, std::vector<PostureSequence> fit,
               std::vector<PostureSequence> test, int threads = 0);

  const std::string& name() const { return name_; }
  const std::vector<PostureSequence>& fit() const { return fit_; }
  const std::vector<PostureSequence>& test() const { return test_; }
  const PackedPostures& packed_fit() const { return packed_fit_; }
  const PackedPostures& packed_test() const { return packed_test_; }
  const Eigen::MatrixXd& fit_distances() const { return fit_distances_; }    // within
  const Eigen::MatrixXd& test_distances() const { return test_distances_; }  // within
  const Eigen::MatrixXd& cross() const { return cross_; }                    // (test, fit)

 private:
  std::string name_;
  std::vector<PostureSequence> fit_, test_;
  PackedPostures packed_fit_, packed_test_;
  Eigen::MatrixXd fit_distances_, test_distances_, cross_;
};

// ((a, c), (c', b)): the distances of two samples from those within and between them.
Eigen::MatrixXd joined_distances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                 const Eigen::MatrixXd& between);
// Mean of d over pairs of different members.
double mean_pair(const Eigen::MatrixXd& distances);
// Median over rows of the smallest entry, without the diagonal where rows are columns.
double median_nearest(const Eigen::MatrixXd& distances, bool without_self = false);

// log_likelihood of each, by the number of its coefficients, so that schemes can stand in one plot.
std::vector<double> likelihoods(const Emulator& emulator,
                                const std::vector<PostureSequence>& sequences, int threads);

struct QuantisedSettings {
  int window = 20, step = 10;  // of the transition matrices, frames
};

// A sample beside the sequences fitted to: quantised sequences and transitions.
struct QuantisedResult {
  Variability variability;  // against the quantised mean sequence of the fit
  double transitions = 0;   // L1 difference to the fit's transition matrices
  double baseline = 0;      // of uniform ones
  std::size_t windows = 0;
};
QuantisedResult test_quantised(const std::vector<Symbols>& sample, const std::vector<Symbols>& fit,
                               const Symbols& mean, int clusters,
                               const QuantisedSettings& settings);

struct SchemeTestOptions {
  SchemeOptions scheme;
  EnergyOptions energy;
  std::int64_t samples = 60;
  std::uint64_t seed = 1;
  int threads = 0;
};

struct SchemeResult {
  std::string scheme;
  Eigen::Index d1 = 0, d2 = 0;
  std::size_t diverged = 0;   // samples left out because they hold values that are not finite
  EnergyTest unseen, fitted;  // samples against the unseen clips, and against those fitted to
  double spread = 0;          // mean distance within the samples, by that within the unseen
  double nearest = 0;     // median distance to the nearest clip fitted to, by the unseen clips' own
  double roughness = 0;   // mean step, by the unseen clips' own
  Eigen::VectorXd steps;  // mean over samples of d(a(t), a(t + 1))
  // Natural logarithms of the model's density, by the number of coefficients.
  std::vector<double> likelihood_fit, likelihood_test, likelihood_samples;
  double likelihood_gap = 0;  // Kolmogorov and Smirnov's, of the samples' and the unseen's
  // How normal the coefficients of the clips fitted to are (numeric/quantiles.h): the median and
  // the smallest correlation of their normal plots; 1 where the scheme has none.
  double normal_median = 1, normal_least = 1;
  std::vector<PostureSequence> samples;
  Eigen::MatrixXd sample_distances, to_test, to_fit;  // within; (samples, test); (samples, fit)
};

// Fits, samples, and compares. When fewer than two samples are finite the tests are left undone,
// with p = 0.
SchemeResult test_scheme(const ClassMotions& motions, const Scheme& scheme,
                         const SchemeTestOptions& options);

}  // namespace mocaplm
