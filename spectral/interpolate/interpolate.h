// A motion between two: gradient descent on the rotation vectors of A until chosen spectral
// features come near B's (thesis 3.5). LibTorch's autograd gives the gradients.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "motion/clip.h"
#include "spectral/interpolate/config.h"

namespace mocaplm {

// Cosine similarities between original, target and result (thesis Table 3.3); not a number where
// the motions are too short for the transform.
struct Similarities {
  double original_target = 0, result_original = 0, result_target = 0;
};

struct InterpolateResult {
  Clip original, target, result;  // of the same length and rate; the result goes A's way (trans)
  Similarities stft;              // of STFT magnitudes (16/8 unless asked otherwise), as the thesis
  Similarities dct;               // of all DCT coefficients
  double error_before = 0, error_after = 0;  // mean squared error to B's features (equation 3.6)
  Eigen::Index features = 0;                 // that took part, of all channels
};

// Loss: weight * |f(x) - f(B)|^2 + (1 - weight) * |f(x) - f(A)|^2, x (T, 72) beginning at A; a step
// is rate times half its gradient. f is linear for dct (orthonormal DCT-II, coefficients within the
// range of frequencies) and pca (orthonormal components over time, learned from the 144 courses of
// both motions), where the features end at weight * f(B) + (1 - weight) * f(A). For stft it is the
// magnitude of Hann windows, scaled so that a rate of 1 is the longest safe step. For own_pca it is
// what x's own 72 courses have of x's own leading components over time, so that the components move
// with x; their signs are those of A's. Whatever x is, its vectors are rotations. Both motions are
// cut to the shorter one's length. Throws UsageError for settings that contradict each other or the
// motions, DataError for motions of one frame or (stft) shorter than a Hann window.
InterpolateResult interpolate(const Clip& a, const Clip& b, const InterpolateConfig& config);

Table interpolate_table(const InterpolateResult& result, const InterpolateConfig& config);

}  // namespace mocaplm
