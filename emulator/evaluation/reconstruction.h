// How much of a motion the components keep (sections 4.2 and 5.1, equation 5).
#pragma once

#include <string>
#include <vector>

#include "emulator/evaluation/scheme_test.h"

namespace mocaplm {

// Mean of sequence_distance between each sequence and its reconstruction from d1 x d2 components
// (0: all), radians summed over limbs. `rebuilt` receives the reconstructions.
double reconstruction_error(const Emulator& emulator, const std::vector<PostureSequence>& sequences,
                            Eigen::Index d1, Eigen::Index d2, int threads = 0,
                            std::vector<PostureSequence>* rebuilt = nullptr);

struct ReconstructionPoint {
  Eigen::Index d1 = 0, d2 = 0;
  double fit = 0, unseen = 0;  // errors
  double p = 1;                // DISCO of the unseen clips against their reconstructions
};

struct ReconstructionCurve {
  std::string representation;               // "SIEM/SequentialPCA"
  std::vector<ReconstructionPoint> points;  // by d1, then d2
};

// The errors over a grid of components. One emulator is fitted with the largest of them; what the
// clips do not allow is left out.
ReconstructionCurve reconstruction_curve(const ClassMotions& motions, const Scheme& scheme,
                                         const SchemeTestOptions& options,
                                         const std::vector<Eigen::Index>& d1,
                                         const std::vector<Eigen::Index>& d2);

}  // namespace mocaplm
