// The two-level simulation of section 5.3: a simple model, fitted to real sequences, makes as much
// data as one wants; emulators are fitted to a part of it and judged by another part that they have
// not seen. What made the data is then known, and the sample is not small.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulator/evaluation/scheme_test.h"

namespace mocaplm {

struct TwoLevelOptions {
  std::vector<std::string> level_one = {"IS-TVF/SequentialPCA/IG", "SIEM/SequentialPCA/IG"};
  // With each representation of level one; PWI stands alone.
  std::vector<std::string> level_two = {"IG", "MVG", "PWI"};
  std::int64_t sequences = 1000;  // of level one
  std::int64_t test = 200;        // of them are set aside, and as many simulated at level two
  Eigen::Index one_d1 = 5, one_d2 = 4, two_d1 = 4, two_d2 = 4;
};

struct TwoLevelResult {
  std::string level_one, level_two;
  EnergyTest test;  // level two's samples against those set aside
  // Log-density under the level-one model, by its number of coefficients.
  std::vector<double> likelihood_test, likelihood_samples;
  double likelihood_gap = 0;
};

// All pairs, level one after level one. `fit` are the real sequences.
std::vector<TwoLevelResult> two_level_simulation(const std::string& name,
                                                 const std::vector<PostureSequence>& fit,
                                                 const TwoLevelOptions& two_level,
                                                 const SchemeTestOptions& options);

}  // namespace mocaplm
