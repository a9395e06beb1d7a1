// From a window of motion to the row of numbers that stands for it (thesis 3.4 and A.1).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "spectral/config.h"
#include "spectral/windows.h"

namespace mocaplm {

//   stft  magnitudes of Hann windows, one-sided: STFT frames * (stft_window / 2 + 1)
//
//   dct   the first `coefficients` of the orthonormal DCT-II
//
//   pca   the first `coefficients` components over time, the same for all channels (A.1)
//
//   pose  the rotations themselves: `window` numbers
//
// of each channel; with config.reduce, the principal components of all of them together.
class FeatureMaker {
 public:
  // `channels` is 3 times the number of joints. Throws UsageError as check_config, and when
  // config.reduce asks for more components than there are features.
  FeatureMaker(const SpectralConfig& config, Eigen::Index channels);

  // Learns the components from windows (window, channels); a sample will do. Needed once where
  // needs_fit(). Throws DataError when values are not finite or there are no windows.
  void fit(const std::vector<Series>& windows);
  bool needs_fit() const { return config_.feature == "pca" || config_.reduce > 0; }

  Eigen::Index dimensions() const;  // of a row
  Eigen::Index raw_dimensions() const { return raw_; }
  // windows of (window, channels) to rows (n, dimensions()).
  Series rows(const std::vector<Series>& windows) const;

  // What fit learned, as it is kept in an index: time basis (coefficients, window) and mean
  // (window), then the reduction's mean (raw) and basis (raw, reduce); empty where not used.
  struct Learned {
    Eigen::MatrixXf time_basis, reduce_basis;
    Eigen::VectorXf time_mean, reduce_mean;
  };
  const Learned& learned() const { return learned_; }
  // Throws DataError when the shapes are not this config's.
  void set_learned(Learned learned, const std::string& place);

 private:
  void raw_row(const Series& window, float* row) const;

  SpectralConfig config_;
  Eigen::Index channels_, raw_;
  Eigen::MatrixXf basis_;  // of the Fourier or cosine transform
  Learned learned_;
};

}  // namespace mocaplm
