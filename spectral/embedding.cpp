#include "spectral/embedding.h"

#include <cassert>

#include "common/error.h"
#include "motion/skeleton.h"
#include "numeric/components.h"
#include "numeric/stft.h"
#include "spectral/frequencies.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kMostFrames = 20000;
using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

// The first component's scores of each part (samples, channels), learned from all of them; not
// centred, so that where nothing moves there is 0.
std::vector<Eigen::VectorXd> first_scores(const std::vector<Eigen::MatrixXd>& parts) {
  Eigen::Index samples = 0;
  for (const Eigen::MatrixXd& part : parts) samples += part.rows();
  Eigen::MatrixXd all(samples, parts.front().cols());
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.middleRows(at, part.rows()) = part;
    at += part.rows();
  }
  const Components first = principal_components(all, 1);
  std::vector<Eigen::VectorXd> scores;
  for (const Eigen::MatrixXd& part : parts) scores.push_back(part * first.analysis.col(0));
  return scores;
}

}  // namespace

std::vector<Eigen::MatrixXd> stft_embeddings(const std::vector<Series>& series,
                                             Eigen::Index stft_window, Eigen::Index hop) {
  assert(!series.empty());
  const Eigen::MatrixXd basis = stft_basis(stft_window);
  std::vector<Eigen::MatrixXd> spectra;
  for (const Series& one : series) {
    if (one.rows() < stft_window)
      throw DataError(in_file("spectrogram"), "the motion has " + std::to_string(one.rows()) +
                                                  " frames, fewer than a Hann window of " +
                                                  std::to_string(stft_window));
    spectra.push_back(stft_magnitudes<double>(RowMajor(one.cast<double>()), basis, hop));
  }
  std::vector<Eigen::MatrixXd> out;
  for (const Eigen::VectorXd& scores : first_scores(spectra))
    out.push_back(scores.reshaped(stft_bins(stft_window), scores.size() / stft_bins(stft_window)));
  return out;
}

std::vector<Eigen::VectorXd> dct_embeddings(const std::vector<Series>& series) {
  assert(!series.empty());
  const Eigen::Index n = series.front().rows();
  if (n > kMostFrames)
    throw DataError(in_file("DCT picture"), "the motion has " + std::to_string(n) +
                                                " frames, more than the limit of " +
                                                std::to_string(kMostFrames));
  std::vector<Eigen::MatrixXd> courses, spectra;
  for (const Series& one : series) {
    courses.push_back(one.cast<double>());
    spectra.emplace_back(n, one.cols());
  }
  visit_dct_rows(n, {0, n}, [&](Eigen::Index first, const Eigen::MatrixXd& basis) {
    for (std::size_t i = 0; i < courses.size(); ++i)
      spectra[i].middleRows(first, basis.rows()) = (basis * courses[i]).cwiseAbs();
  });
  return first_scores(spectra);
}

Series whole_series(const Clip& clip) {
  return window_series(clip, 0, clip.frames(), parse_joints({"all"}));
}

}  // namespace mocaplm
