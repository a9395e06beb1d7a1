// Spectra of the whole body in one picture: the first principal component over the channels (thesis
// A.1.1).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "spectral/windows.h"

namespace mocaplm {

// For each series (frames, channels) the first principal component of its STFT magnitudes:
// (bins, STFT frames). Points in time and frequency are the samples, channels the variables, and
// the component is the same for all series, so that their pictures can be compared; no movement is
// 0. Throws
// DataError when a series is shorter than the Hann window.
std::vector<Eigen::MatrixXd> stft_embeddings(const std::vector<Series>& series,
                                             Eigen::Index stft_window, Eigen::Index hop);

// The same for the magnitudes of the DCT coefficients of each series: (frames). All of the same
// length, at most 20000 frames (DataError).
std::vector<Eigen::VectorXd> dct_embeddings(const std::vector<Series>& series);

// All 24 joints' rotations of a whole clip.
Series whole_series(const Clip& clip);

}  // namespace mocaplm
