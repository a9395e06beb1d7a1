#include "numeric/stft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "common/angles.h"
#include "common/random.h"

namespace mocaplm::stft_test {
namespace {

using Signal = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

Signal noise(Eigen::Index samples, Eigen::Index channels, std::uint64_t seed) {
  Random random(seed);
  Signal signal(samples, channels);
  for (Eigen::Index i = 0; i < signal.size(); ++i) signal.data()[i] = random.normal();
  return signal;
}

TEST(Stft, HannsWindowIsTheFormula) {
  const Eigen::VectorXd window = hann_window(16);
  EXPECT_EQ(window[0], 0);
  EXPECT_NEAR(window[4], 0.5, 1e-15);
  EXPECT_NEAR(window[8], 1, 1e-15);
  EXPECT_NEAR(window.sum(), 8, 1e-12);
  // Halves that overlap add to one.
  for (Eigen::Index t = 0; t < 8; ++t) EXPECT_NEAR(window[t] + window[t + 8], 1, 1e-15);
}

TEST(Stft, EqualsThePlainSums) {
  for (const Eigen::Index n : {1, 2, 7, 16, 32})
    for (const Eigen::Index hop : {1, 3, 16}) {
      const Signal signal = noise(50, 2, 3);
      const Eigen::MatrixXd found = stft_magnitudes<double>(signal, stft_basis(n), hop);
      const Eigen::VectorXd window = hann_window(n);
      ASSERT_EQ(found.rows(), stft_frames(50, n, hop) * stft_bins(n));
      Eigen::Index row = 0;
      for (Eigen::Index start = 0; start + n <= 50; start += hop)
        for (Eigen::Index k = 0; k <= n / 2; ++k, ++row)
          for (Eigen::Index c = 0; c < 2; ++c) {
            std::complex<double> sum = 0;
            for (Eigen::Index t = 0; t < n; ++t)
              sum += signal(start + t, c) * window[t] *
                     std::exp(std::complex<double>(0, -2 * kPi * double(k * t) / double(n)));
            EXPECT_NEAR(found(row, c), std::abs(sum), 1e-12);
          }
      EXPECT_EQ(row, found.rows());
    }
}

// A cosine of k whole turns in a window lies in bin k (half the window's sum), its neighbours get
// half of that, and a shift in time changes nothing.
TEST(Stft, FindsAFrequencyWhateverItsPhase) {
  for (const double phase : {0.0, 0.7, 2.0}) {
    Signal signal(64, 1);
    for (Eigen::Index t = 0; t < 64; ++t)
      signal(t, 0) = std::cos(2 * kPi * 4 * double(t) / 16 + phase);
    const Eigen::MatrixXd found = stft_magnitudes<double>(signal, stft_basis(16), 8);
    for (Eigen::Index f = 0; f < stft_frames(64, 16, 8); ++f)
      for (Eigen::Index k = 0; k < 9; ++k)
        EXPECT_NEAR(found(f * 9 + k, 0), k == 4 ? 4.0 : k == 3 || k == 5 ? 2.0 : 0.0, 1e-12);
  }
}

TEST(Stft, ShortSignalsHaveNoFrames) {
  EXPECT_EQ(stft_frames(15, 16, 8), 0);
  EXPECT_EQ(stft_frames(16, 16, 8), 1);
  EXPECT_EQ(stft_frames(128, 16, 8), 15);
  EXPECT_EQ(stft_magnitudes<double>(noise(3, 2, 1), stft_basis(16), 8).rows(), 0);
}

TEST(Stft, FloatsAgreeWithDoubles) {
  const Signal signal = noise(128, 5, 9);
  const Eigen::MatrixXd exact = stft_magnitudes<double>(signal, stft_basis(32), 16);
  const Eigen::MatrixXf quick =
      stft_magnitudes<float>(signal.cast<float>().eval(), stft_basis(32).cast<float>().eval(), 16);
  EXPECT_LT((quick.cast<double>() - exact).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace mocaplm::stft_test
