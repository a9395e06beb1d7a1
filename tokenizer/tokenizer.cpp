#include "tokenizer/tokenizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/settings.h"
#include "motion/skeleton.h"
#include "tokenizer/root_motion.h"

namespace mocaplm {

namespace {

// Frames that quantile bins are fitted on at most: 7 hours at 20 a second, then every second, ...
constexpr std::size_t kMostFitted = 500000;

}  // namespace

Tokenizer Tokenizer::fit(const TokenizerConfig& config, const std::vector<Clip>& clips) {
  return fit(config, clips.size(), [&](std::size_t i) { return clips[i]; });
}

Tokenizer Tokenizer::fit(const TokenizerConfig& config, std::size_t count,
                         const std::function<Clip(std::size_t)>& clip) {
  Tokenizer tokenizer;
  const Json settings = settings_json(config);
  JsonObject object(settings, "tokenizer settings");
  read_settings(tokenizer.config_, object);  // checks every range
  tokenizer.joints_ = parse_joints(config.joints);
  if (tokenizer.joints_.empty()) throw UsageError("the tokenizer needs at least one joint");
  tokenizer.config_.joints.clear();
  for (const int joint : tokenizer.joints_)
    tokenizer.config_.joints.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  const bool uniform = config.binning == "uniform", root = config.root != "none";
  const auto rotations = static_cast<std::size_t>(tokenizer.rotation_channels());
  tokenizer.low_.assign(rotations, -kPi);
  tokenizer.high_.assign(rotations, kPi);
  if (uniform && !root) return tokenizer;

  if (count == 0)
    throw UsageError(uniform ? "fitting the root's ranges needs at least one clip, or root = none"
                             : "fitting quantile bins needs at least one clip");
  const std::size_t channels = rotations + (root ? 3 : 0);
  tokenizer.low_.resize(channels);
  tokenizer.high_.resize(channels);
  // Uniform bins look at the root alone, of which a whole collection fits in memory.
  const std::size_t first = uniform ? rotations : 0;
  RowSample values(channels - first, uniform ? std::size_t(-1) : kMostFitted);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::MatrixXd all = tokenizer.channel_values(clip(i));
    for (Eigen::Index t = 0; t < all.rows(); ++t)
      values.add(all.row(t).tail(static_cast<Eigen::Index>(channels - first)));
  }
  if (root) tokenizer.fit_ranges(values);
  if (!uniform) tokenizer.fit_bins(values);
  return tokenizer;
}

void Tokenizer::fit_ranges(const RowSample& values) {
  const auto rotations = static_cast<std::size_t>(rotation_channels());
  const std::size_t first = values.columns() - 3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool step = config_.root == "steps" && axis != 1;
    const std::vector<double>& column = values.column(first + axis);
    const ValueRange range = step ? step_range(column, bins(), axis == 0) : absolute_range(column);
    low_[rotations + axis] = range.low;
    high_[rotations + axis] = range.high;
  }
}

void Tokenizer::fit_bins(const RowSample& values) {
  const auto rotations = static_cast<std::size_t>(rotation_channels());
  pooled_ = config_.binning == "pooled_quantile";
  std::vector<double> all;
  for (std::size_t c = 0; pooled_ && c < rotations; ++c)
    all.insert(all.end(), values.column(c).begin(), values.column(c).end());
  if (pooled_) fitted_.push_back(Bins::quantile(std::move(all), bins()));
  for (std::size_t c = pooled_ ? rotations : 0; c < values.columns(); ++c)
    fitted_.push_back(Bins::quantile(values.column(c), bins()));
  // Who does not step stays: left and forward.
  if (config_.root == "steps")
    for (const std::size_t back : {std::size_t{3}, std::size_t{1}})
      fitted_[fitted_.size() - back].keep_zero();
}

std::string Tokenizer::channel_name(int channel) const {
  assert(channel >= 0 && channel <= channels());
  if (channel == channels()) return "separator";
  const int joint = channel_joint(channel);
  if (joint >= 0) return joint_names()[static_cast<std::size_t>(joint)] + "." + "xyz"[channel % 3];
  const int axis = channel - rotation_channels();
  if (config_.root == "absolute") return std::string("root.") + "xyz"[axis];
  return axis == 0 ? "root.left" : axis == 1 ? "root.height" : "root.forward";
}

int Tokenizer::channel_joint(int channel) const {
  return channel < rotation_channels() ? joints_[static_cast<std::size_t>(channel / 3)] : -1;
}

}  // namespace mocaplm
