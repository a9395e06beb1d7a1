#include "spectral/features.h"

#include <algorithm>
#include <cassert>

#include "common/error.h"
#include "numeric/components.h"
#include "numeric/dct.h"
#include "numeric/leading_components.h"
#include "numeric/stft.h"

namespace mocaplm {

namespace {

// Courses that the components over time are learned from: enough for 4096 x 4096 covariances.
constexpr Eigen::Index kMostCourses = 60000;
// Rows that are reduced at once.
constexpr std::size_t kWindowsAtOnce = 256;

}  // namespace

FeatureMaker::FeatureMaker(const SpectralConfig& config, Eigen::Index channels)
    : config_(config), channels_(channels) {
  check_config(config);
  if (config.feature == "stft") {
    basis_ = stft_basis(config.stft_window).cast<float>();
    raw_ = stft_frames(config.window, config.stft_window, config.hop()) *
           stft_bins(config.stft_window) * channels;
  } else if (config.feature == "dct") {
    basis_ = dct_matrix(config.window).topRows(config.coefficients).cast<float>();
    raw_ = config.coefficients * channels;
  } else {
    raw_ = (config.feature == "pca" ? config.coefficients : config.window) * channels;
  }
  if (config.reduce > raw_)
    throw UsageError("reduce asks for " + std::to_string(config.reduce) +
                     " components, but a window has " + std::to_string(raw_) + " features");
}

Eigen::Index FeatureMaker::dimensions() const {
  return config_.reduce > 0 ? config_.reduce : raw_;
}

void FeatureMaker::raw_row(const Series& window, float* row) const {
  assert(window.rows() == config_.window && window.cols() == channels_);
  Eigen::Map<Eigen::MatrixXf> out(row, raw_ / channels_, channels_);
  if (config_.feature == "stft")
    out = stft_magnitudes<float>(window, basis_, config_.hop());
  else if (config_.feature == "dct")
    out.noalias() = basis_ * window;
  else if (config_.feature == "pca")
    out.noalias() = learned_.time_basis * (window.colwise() - learned_.time_mean);
  else
    out = window;
}

void FeatureMaker::fit(const std::vector<Series>& windows) {
  if (windows.empty())
    throw DataError(in_file("spectral features"), "there are no windows to learn from");
  if (config_.feature == "pca") {
    const auto every = static_cast<Eigen::Index>(windows.size()) * channels_ / kMostCourses + 1;
    std::vector<Eigen::VectorXd> courses;
    for (std::size_t w = 0; w < windows.size(); w += static_cast<std::size_t>(every))
      for (Eigen::Index c = 0; c < channels_; ++c)
        courses.push_back(windows[w].col(c).cast<double>());
    Eigen::MatrixXd x(static_cast<Eigen::Index>(courses.size()), config_.window);
    for (std::size_t i = 0; i < courses.size(); ++i)
      x.row(static_cast<Eigen::Index>(i)) = courses[i].transpose();
    const Components components = principal_components(x, config_.coefficients);
    learned_.time_basis = components.synthesis.cast<float>();
    learned_.time_mean = components.mean.transpose().cast<float>();
  }
  if (config_.reduce == 0) return;
  Series raw(static_cast<Eigen::Index>(windows.size()), raw_);
  for (std::size_t w = 0; w < windows.size(); ++w)
    raw_row(windows[w], raw.row(static_cast<Eigen::Index>(w)).data());
  const LeadingComponents found = leading_components(Eigen::MatrixXf(raw), config_.reduce);
  learned_.reduce_mean = found.mean.transpose();
  learned_.reduce_basis = found.basis;
}

Series FeatureMaker::rows(const std::vector<Series>& windows) const {
  Series out(static_cast<Eigen::Index>(windows.size()), dimensions());
  if (config_.reduce == 0) {
    for (std::size_t w = 0; w < windows.size(); ++w)
      raw_row(windows[w], out.row(static_cast<Eigen::Index>(w)).data());
    return out;
  }
  for (std::size_t first = 0; first < windows.size(); first += kWindowsAtOnce) {
    const std::size_t count = std::min(kWindowsAtOnce, windows.size() - first);
    Series raw(static_cast<Eigen::Index>(count), raw_);
    for (std::size_t w = 0; w < count; ++w)
      raw_row(windows[first + w], raw.row(static_cast<Eigen::Index>(w)).data());
    raw.rowwise() -= learned_.reduce_mean.transpose();
    out.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)).noalias() =
        raw * learned_.reduce_basis;
  }
  return out;
}

void FeatureMaker::set_learned(Learned learned, const std::string& place) {
  const Eigen::Index k = config_.feature == "pca" ? config_.coefficients : 0;
  const Eigen::Index frames = k > 0 ? config_.window : 0;
  const Eigen::Index raw = config_.reduce > 0 ? raw_ : 0;
  if (learned.time_basis.rows() != k || learned.time_basis.cols() != frames ||
      learned.time_mean.size() != frames || learned.reduce_basis.rows() != raw ||
      learned.reduce_basis.cols() != config_.reduce || learned.reduce_mean.size() != raw)
    throw DataError(in_file(place), "holds components of another shape than its settings say");
  learned_ = std::move(learned);
}

}  // namespace mocaplm
