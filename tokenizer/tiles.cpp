#include "tokenizer/tiles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/settings.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/alphabet.h"

namespace mocaplm {

namespace {

// No component of a rotation vector is larger; two turns give way to nearly all dances.
constexpr double kLargest = 4 * kPi;
constexpr double kRounding = 1e-9;                   // smaller coefficients are rounding
constexpr std::size_t kMostRows = 300000;            // that components are fitted on
constexpr std::size_t kMostIndependentRows = 40000;  // FastICA goes over them many times
constexpr std::size_t kMostCoefficients = 8000000;   // that bins are fitted on

template <class Config>
Config checked(const Config& config) {
  Config read;
  const Json settings = settings_json(config);
  JsonObject object(settings, "tokenizer settings");
  read_settings(read, object);
  return read;
}

Eigen::MatrixXd sample_rows(const std::vector<Eigen::MatrixXd>& values, std::size_t most) {
  RowSample sample(static_cast<std::size_t>(values.front().cols()), most);
  for (const Eigen::MatrixXd& clip : values)
    for (Eigen::Index t = 0; t < clip.rows(); ++t) sample.add(clip.row(t));
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(sample.column(0).size()), values.front().cols());
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    const std::vector<double>& column = sample.column(static_cast<std::size_t>(c));
    rows.col(c) = Eigen::Map<const Eigen::VectorXd>(column.data(), rows.rows());
  }
  return rows;
}

}  // namespace

TileTokenizer::TileTokenizer(const TokenizerConfig& frames, const TileConfig& tiles)
    : frames_(checked(frames)), tiles_(checked(tiles)), joints_(parse_joints(frames.joints)) {
  if (joints_.empty()) throw UsageError("the tokenizer needs at least one joint");
  if (tiles_.tiles < 1) throw UsageError("a tile needs at least one frame");
  if (frames_.root == "steps")
    throw UsageError(
        "tiles tell the root as absolute or none: the errors of steps would add up (see "
        "docs/tokenizers.md)");
  if (tiles_.pca > 0 && tiles_.ica > 0)
    throw UsageError("components are either principal (pca) or independent (ica), not both");
  if (std::max(tiles_.pca, tiles_.ica) > channels())
    throw UsageError(std::to_string(std::max(tiles_.pca, tiles_.ica)) + " components of only " +
                     std::to_string(channels()) + " channels");
  if (characters() > kAlphabetSize)
    throw UsageError(std::to_string(bins()) + " bins and " + std::to_string(tiles_.runs) +
                     " runs are more than the " + std::to_string(kAlphabetSize) +
                     " characters that there are");
  frames_.joints.clear();
  for (const int joint : joints_)
    frames_.joints.push_back(joint_names()[static_cast<std::size_t>(joint)]);
}

void TileTokenizer::make_transforms() {
  dct_ = dct_matrix(tiles_.tiles);
  lap_ = LapFilter(tiles_.lapped ? tiles_.tiles : 1);
}

TileTokenizer TileTokenizer::fit(const TokenizerConfig& frames, const TileConfig& tiles,
                                 std::size_t count, const std::function<Clip(std::size_t)>& clip) {
  const TileTokenizer checks(frames, tiles);
  std::vector<Eigen::MatrixXd> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(checks.channel_values(clip(i)));
  return fit_values(frames, tiles, values);
}

TileTokenizer TileTokenizer::fit_values(const TokenizerConfig& frames, const TileConfig& tiles,
                                        const std::vector<Eigen::MatrixXd>& values) {
  TileTokenizer tokenizer(frames, tiles);
  if (values.empty()) throw UsageError("fitting tiles needs at least one clip");
  tokenizer.fit_components(values);
  tokenizer.make_transforms();
  tokenizer.fit_bins(values);
  return tokenizer;
}

void TileTokenizer::fit_components(const std::vector<Eigen::MatrixXd>& values) {
  const Eigen::MatrixXd rows =
      sample_rows(values, tiles_.ica > 0 ? kMostIndependentRows : kMostRows);
  if (tiles_.ica > 0) {
    basis_ = independent_components(rows, tiles_.ica);
  } else if (tiles_.pca > 0) {
    basis_ = principal_components(rows, tiles_.pca);
  } else {
    basis_.mean = rows.colwise().mean();
    basis_.analysis = basis_.synthesis = Eigen::MatrixXd::Identity(channels(), channels());
  }
}

Eigen::MatrixXd TileTokenizer::transform(const Eigen::MatrixXd& values) const {
  const Eigen::Index n = tiles_.tiles, tiles = (values.rows() + n - 1) / n;
  Eigen::MatrixXd all(tiles * n, values.cols());
  all.topRows(values.rows()) = values;
  all.bottomRows(all.rows() - values.rows()).rowwise() = values.row(values.rows() - 1);
  Eigen::MatrixXd coefficients = basis_.project(all);
  lap_.apply(coefficients);
  for (Eigen::Index tile = 0; tile < tiles; ++tile)
    coefficients.middleRows(tile * n, n) = (dct_ * coefficients.middleRows(tile * n, n)).eval();
  return coefficients;
}

Eigen::MatrixXd TileTokenizer::inverse(Eigen::MatrixXd coefficients) const {
  const Eigen::Index n = tiles_.tiles;
  for (Eigen::Index first = 0; first < coefficients.rows(); first += n)
    coefficients.middleRows(first, n) =
        (dct_.transpose() * coefficients.middleRows(first, n)).eval();
  lap_.undo(coefficients);
  return basis_.restore(coefficients);
}

double TileTokenizer::least_kept(const Eigen::Ref<const Eigen::MatrixXd>& tile) const {
  const auto all = static_cast<std::size_t>(tile.size());
  const auto kept = static_cast<std::size_t>(std::clamp(
      std::llround(tiles_.keep * static_cast<double>(all)), 1LL, static_cast<long long>(all)));
  std::vector<double> sizes;
  sizes.reserve(all);
  for (Eigen::Index c = 0; c < tile.cols(); ++c)
    for (Eigen::Index k = 0; k < tile.rows(); ++k) sizes.push_back(std::abs(tile(k, c)));
  const auto last = sizes.begin() + static_cast<std::ptrdiff_t>(kept - 1);
  std::nth_element(sizes.begin(), last, sizes.end(), std::greater<>());
  return std::max({*last, tiles_.threshold, kRounding});
}

void TileTokenizer::fit_bins(const std::vector<Eigen::MatrixXd>& values) {
  const bool uniform = frames_.binning == "uniform", pooled = frames_.binning != "quantile";
  const Eigen::Index n = tiles_.tiles;
  const std::size_t sets = pooled ? 1 : static_cast<std::size_t>(components());
  std::vector<RowSample> kept(sets, RowSample(1, kMostCoefficients / sets));
  double largest = 1e-6;
  for (const Eigen::MatrixXd& clip : values) {
    const Eigen::MatrixXd all = transform(clip);
    for (Eigen::Index first = 0; first < all.rows(); first += n) {
      const double least = least_kept(all.middleRows(first, n));
      for (Eigen::Index c = 0; c < all.cols(); ++c)
        for (Eigen::Index k = 0; k < n; ++k) {
          const double value = all(first + k, c);
          if (std::abs(value) < least) continue;
          largest = std::max(largest, std::abs(value));
          if (!uniform)
            kept[pooled ? 0 : static_cast<std::size_t>(c)].add(std::array<double, 1>{value});
        }
    }
  }
  for (const RowSample& set : kept) {
    if (uniform)
      fitted_.push_back(
          Bins::around_zero(largest / std::max(1, bins() / 2), std::max(1, bins() / 2)));
    else if (set.column(0).empty())
      fitted_.push_back(Bins::quantile({0}, 1));  // a component that is never kept
    else
      fitted_.push_back(Bins::quantile(set.column(0), bins()));
  }
}

Eigen::MatrixXd TileTokenizer::channel_values(const TokenizerConfig& frames,
                                              const std::vector<int>& joints, const Clip& given) {
  Clip clip = resample(given, frames.fps, joints);
  keep_continuous(clip, kLargest);
  const auto rotations = static_cast<Eigen::Index>(3 * joints.size());
  const bool root = frames.root != "none";
  Eigen::MatrixXd values(clip.frames(), rotations + (root ? 3 : 0));
  for (std::size_t i = 0; i < joints.size(); ++i)
    values.middleCols<3>(static_cast<Eigen::Index>(3 * i)) =
        clip.poses.middleCols<3>(3 * joints[i]);
  if (root) {
    values.rightCols<3>() = clip.trans;
    for (const Eigen::Index axis : {rotations, rotations + 2})
      values.col(axis).array() -= values(0, axis);
  }
  return values;
}

Eigen::MatrixXd TileTokenizer::channel_values(const Clip& clip) const {
  check_clip(clip, clip.name.empty() ? "clip" : clip.name);
  return channel_values(frames_, joints_, clip);
}

Clip TileTokenizer::motion(const Eigen::MatrixXd& values, const std::string& name,
                           const Eigen::Vector3d& start) const {
  Clip clip;
  clip.name = name;
  clip.fps = frames_.fps;
  clip.poses = Poses::Zero(values.rows(), 72);
  for (std::size_t i = 0; i < joints_.size(); ++i)
    clip.poses.middleCols<3>(3 * joints_[i]) =
        values.middleCols<3>(static_cast<Eigen::Index>(3 * i));
  clip.trans = start.transpose().replicate(values.rows(), 1);
  if (tells_root()) {
    clip.trans.leftCols<1>() += values.col(values.cols() - 3);
    clip.trans.col(1) = values.col(values.cols() - 2);
    clip.trans.rightCols<1>() += values.col(values.cols() - 1);
  }
  return clip;
}

}  // namespace mocaplm
