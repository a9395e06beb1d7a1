// Postures as points of (S^2)^L, one unit direction a limb, and sequences of them (section 3.1).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/error.h"

namespace mocaplm {

using Posture = Eigen::Matrix3Xd;         // (3, L): column i is the unit direction of limb i
using PostureTangent = Eigen::Matrix3Xd;  // (3, L): column i is orthogonal to the posture's

// A motion without place, size and proportions.
struct PostureSequence {
  Eigen::MatrixXd values;  // (3 L, T): column t is the posture at frame t, limb after limb

  Eigen::Index limbs() const { return values.rows() / 3; }
  Eigen::Index frames() const { return values.cols(); }
  Eigen::Map<const Posture> at(Eigen::Index t) const { return {values.col(t).data(), 3, limbs()}; }
  Eigen::Map<Posture> at(Eigen::Index t) { return {values.col(t).data(), 3, limbs()}; }
};

// Throws DataError naming the frame and limb of the first direction that is not finite or not of
// unit length (1e-6), or when there is no limb or no frame.
void check_sequence(const PostureSequence& sequence, const Place& place);

// Equation 1: the sum over limbs of the angles between them, radians.
double posture_distance(const Posture& y, const Posture& z);
// The Riemannian distance of the product: the root of the sum of squared angles.
double posture_geodesic_distance(const Posture& y, const Posture& z);
// Equations 2 and 3 and the transport, limb by limb (emulator/sphere.h).
PostureTangent posture_log(const Posture& y, const Posture& z);
Posture posture_exp(const Posture& y, const PostureTangent& v);
PostureTangent posture_transport(const PostureTangent& v, const Posture& y, const Posture& z);

// The posture of least sum of squared geodesic distances to all frames of all sequences (the
// Karcher mean). `at_most` frames are looked at, evenly spread; 0 for all.
Posture mean_posture(const std::vector<PostureSequence>& sequences, Eigen::Index at_most = 0);
// The mean at each frame (equation 6, the first half); all sequences have the same length.
PostureSequence mean_sequence(const std::vector<PostureSequence>& sequences, int threads = 0);

// Equation 4: the mean over frames of posture_distance. Both have the same frames and limbs. For
// many pairs: emulator/distances.h.
double sequence_distance(const PostureSequence& a, const PostureSequence& b);

// The posture at `time` in frames, 0 .. T - 1, on the geodesic between the two frames around it.
Posture posture_at(const PostureSequence& sequence, double time);
// The sequence read at these times, in frames.
PostureSequence read_at(const PostureSequence& sequence, const Eigen::VectorXd& times);
// Linear time normalisation: `frames` >= 2 postures evenly spread from the first to the last frame.
// Throws DataError when the sequence has one frame.
PostureSequence normalised(const PostureSequence& sequence, Eigen::Index frames);

}  // namespace mocaplm
