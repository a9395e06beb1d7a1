// Temporal alignment of posture sequences by their single-hop transported square-root velocity
// fields (section 3.2; Su, Kurtek, Klassen, Srivastava 2014) and dynamic programming over warpings.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "emulator/sequence.h"

namespace mocaplm {

struct AlignOptions {
  std::string align = "mean";
  std::int64_t iterations = 4;
  std::int64_t steepest = 4;
  double stiffness = 0;
  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("align", align, {"none", "reference", "mean"},
             "align in time: not at all (evenly), to one clip, or to an iterated mean");
    v.integer("iterations", iterations, 1, 20, "rounds of aligning to the mean of the last round");
    v.integer("steepest", steepest, 1, 8, "a warping's slopes are p / q with p and q up to this");
    v.number("stiffness", stiffness, 0, 1e6,
             "cost of the square-root slope's distance from 1; 0: free warping");
  }
};

// h(t) = velocity / sqrt(|velocity|), transported to `reference` in one hop, in the tangent basis
// there: (2 L, T - 1), constant on each interval between frames, time in [0, 1]. Zero where nothing
// moves. The squared L2 distance of two of them does not change when both are warped alike.
Eigen::MatrixXd square_root_velocity(const PostureSequence& sequence, const Posture& reference);

// The warping g of [0, 1] that minimises
//   integral |fixed(t) - moved(g(t)) sqrt(g'(t))|^2 dt + stiffness integral (sqrt(g') - 1)^2 dt
// over piecewise linear ones through the grid of intervals' ends, as times in intervals: (n + 1)
// with g(0) = 0, g(n) = n, strictly increasing. Integrals are exact for fields constant on
// intervals; both have n columns. `cost` receives the minimum.
Eigen::VectorXd best_warping(const Eigen::MatrixXd& fixed, const Eigen::MatrixXd& moved,
                             const AlignOptions& options, double* cost = nullptr);

struct Alignment {
  PostureSequence sequence;  // (3 L, T) aligned
  Eigen::VectorXd warping;   // (T): where in the source, as a share of its length, each frame lies
  double amount = 0;         // arccos of integral sqrt(g'): 0 for no warping, at most pi / 2
  double before = 0, after = 0;  // L2 distance of the fields, to the template
};

// The sequence, of any length, aligned to `fixed` (T frames).
Alignment align_to(const PostureSequence& sequence, const PostureSequence& fixed,
                   const Posture& reference, const AlignOptions& options);

struct Aligned {
  std::vector<Alignment> items;
  PostureSequence fixed;  // the template: what others are aligned to; T frames
  Posture reference;      // of the fields
};

// All sequences, each of its own length, with `frames` frames. "none": evenly; "reference": to
// sequence number `reference`; "mean": to that one first, then to the mean of the result, and so
// on (the mean's warpings are brought to a mean of no warping). Throws DataError for a sequence of
// one frame, UsageError for fewer than 2 frames or sequences that differ in limbs.
Aligned align_all(const std::vector<PostureSequence>& sequences, Eigen::Index frames,
                  const AlignOptions& options, std::size_t reference = 0, int threads = 0);

// Which sequence others are aligned to first: the one of least sum of sequence_distance to all,
// after linear time normalisation.
std::size_t central_sequence(const std::vector<PostureSequence>& sequences, Eigen::Index frames,
                             int threads = 0);

}  // namespace mocaplm
