#include "tokenizer/tokenizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/error.h"
#include "common/settings.h"
#include "motion/skeleton.h"
#include "tokenizer/root_motion.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;

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
  const auto rotations = static_cast<std::size_t>(tokenizer.rotation_channels());
  tokenizer.low_.assign(rotations, -kPi);
  tokenizer.high_.assign(rotations, kPi);
  if (config.root == "none") return tokenizer;

  if (count == 0)
    throw UsageError("fitting the root's ranges needs at least one clip, or root = none");
  tokenizer.low_.resize(rotations + 3);
  tokenizer.high_.resize(rotations + 3);
  std::vector<double> values[3];
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::MatrixXd all = tokenizer.channel_values(clip(i));
    for (Eigen::Index t = 0; t < all.rows(); ++t)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        values[axis].push_back(all(t, static_cast<Eigen::Index>(rotations) + axis));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool step = config.root == "steps" && axis != 1;
    const ValueRange range =
        step ? step_range(values[axis], tokenizer.bins(), axis == 0) : absolute_range(values[axis]);
    tokenizer.low_[rotations + axis] = range.low;
    tokenizer.high_[rotations + axis] = range.high;
  }
  return tokenizer;
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
