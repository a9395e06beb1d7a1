#include "tokenizer/tokenizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/error.h"
#include "common/settings.h"
#include "common/text.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/root_motion.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kPelvis = 0;
// 14 hours at 20 frames per second: more comes from a wrong frame rate, and would not fit in
// memory.
constexpr double kMaxFrames = 1e6;

Clip at_rate(const Clip& clip, double fps) {
  const std::string name = clip.name.empty() ? "clip" : clip.name;
  check_clip(clip, name);
  if (std::abs(clip.fps - fps) < 1e-9) return clip;
  if (clip.seconds() * fps > kMaxFrames)
    throw DataError(in_file(name), "lasts " + format_duration(clip.seconds()) + " by its rate of " +
                                       format_number(clip.fps) +
                                       " frames per second, which is too long; is the rate right?");
  return resample(clip, fps);
}

bool has_pelvis(const std::vector<int>& joints) {
  return std::find(joints.begin(), joints.end(), kPelvis) != joints.end();
}

}  // namespace

Tokenizer Tokenizer::fit(const TokenizerConfig& config, const std::vector<Clip>& clips) {
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

  if (clips.empty())
    throw UsageError("fitting the root's ranges needs at least one clip, or root = none");
  tokenizer.low_.resize(rotations + 3);
  tokenizer.high_.resize(rotations + 3);
  std::vector<double> values[3];
  for (const Clip& clip : clips) {
    const Eigen::MatrixXd all = tokenizer.channel_values(clip);
    for (Eigen::Index t = 0; t < all.rows(); ++t)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        values[axis].push_back(all(t, static_cast<Eigen::Index>(rotations) + axis));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool step = config.root == "steps" && axis != 1;
    const BinRange range =
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

double Tokenizer::bin_centre(int channel, int bin) const {
  const auto c = static_cast<std::size_t>(channel);
  return low_[c] + (high_[c] - low_[c]) * (bin + 0.5) / bins();
}

int Tokenizer::bin_of(int channel, double value, bool* clamped) const {
  const auto c = static_cast<std::size_t>(channel);
  if (clamped) *clamped = value < low_[c] || value > high_[c];
  const double bin = std::floor((value - low_[c]) / (high_[c] - low_[c]) * bins());
  return static_cast<int>(std::clamp(bin, 0.0, bins() - 1.0));
}

// A vector of three bin centres is one that this tokenizer decoded: it is kept, so that decoded
// motion is encoded back to the very same tokens even where the choice between equal rotations is
// close.
bool Tokenizer::is_decoded(const Eigen::Vector3d& v, int first) const {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(v[axis] - bin_centre(first + axis, bin_of(first + axis, v[axis]))) > 1e-12)
      return false;
  return true;
}

Eigen::MatrixXd Tokenizer::channel_values(const Clip& given) const {
  const Clip clip = at_rate(given, config_.fps);
  Eigen::MatrixXd values(clip.frames(), channels());
  for (int first = 0; first < rotation_channels(); first += 3) {
    Eigen::Vector3d previous;
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const Eigen::Vector3d v = clip.poses.row(t).segment<3>(3 * channel_joint(first)).transpose();
      if (is_decoded(v, first))
        previous = v;
      else if (t == 0)
        previous = axis_angle_from_quaternion(quaternion_from_axis_angle(v));
      else
        previous = continuous_axis_angle(v, previous, kPi);
      // Rounding must not push a component past the outermost bin.
      values.row(t).segment<3>(first) = previous.transpose().cwiseMax(-kPi).cwiseMin(kPi);
    }
  }
  if (config_.root == "none") return values;
  const bool turns = has_pelvis(joints_);  // otherwise the decoder does not know the heading either
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    Eigen::Vector3d root = clip.trans.row(t).transpose();
    if (config_.root == "steps") {
      const Eigen::RowVector3d step =
          clip.trans.row(t) - clip.trans.row(std::max<Eigen::Index>(t - 1, 0));
      const double yaw = turns ? heading(clip.poses.row(t).head<3>().transpose()) : 0;
      const Eigen::Vector2d own = to_dancer({step.x(), step.z()}, yaw);
      root = {own.x(), root.y(), own.y()};
    }
    values.row(t).tail<3>() = root.transpose();
  }
  return values;
}

TokenStream Tokenizer::encode(const Clip& given, EncodeReport* report) const {
  const Clip clip = at_rate(given, config_.fps);
  Eigen::MatrixXd values = channel_values(clip);
  const bool steps = config_.root == "steps", turns = has_pelvis(joints_);
  TokenStream stream;
  const auto size =
      static_cast<std::size_t>(values.rows()) * static_cast<std::size_t>(tokens_per_frame());
  stream.ids.reserve(size);
  stream.frame.reserve(size);
  stream.channel.reserve(size);
  const auto push = [&](std::int32_t id, Eigen::Index frame, int channel) {
    stream.ids.push_back(id);
    stream.frame.push_back(static_cast<std::int32_t>(frame));
    stream.channel.push_back(channel);
  };
  EncodeReport counts;
  // Where the decoder believes the dancer to be: a step is measured from there and in the decoded
  // heading, so that rounding never accumulates.
  Eigen::Vector2d believed(clip.trans(0, 0), clip.trans(0, 2));
  for (Eigen::Index t = 0; t < values.rows(); ++t) {
    Eigen::VectorXd decoded(channels());
    double yaw = 0;
    for (int c = 0; c < channels(); ++c) {
      if (steps && c == rotation_channels()) {
        yaw = turns ? heading(decoded.head<3>()) : 0;
        const Eigen::Vector2d way(clip.trans(t, 0) - believed.x(), clip.trans(t, 2) - believed.y());
        const Eigen::Vector2d step = to_dancer(way, yaw);
        values(t, c) = step.x();
        values(t, c + 2) = step.y();
      }
      bool clamped = false;
      const int bin = bin_of(c, values(t, c), &clamped);
      decoded[c] = bin_centre(c, bin);
      counts.clamped += clamped;
      push(kFirstBin + bin, t, c);
    }
    if (steps) believed += to_floor({decoded[channels() - 3], decoded[channels() - 1]}, yaw);
    push(kSeparator, t, channels());
  }
  counts.values = values.size();
  if (report) {
    report->values += counts.values;
    report->clamped += counts.clamped;
  }
  return stream;
}

Clip Tokenizer::decode(const std::vector<std::int32_t>& ids, const std::string& name,
                       const Eigen::Vector3d& start) const {
  const std::string file = name.empty() ? "token stream" : name;
  const auto width = static_cast<std::size_t>(tokens_per_frame());
  if (ids.empty())
    throw DataError(in_file(file),
                    "holds no tokens, expected whole frames of " + std::to_string(width));
  const auto refuse = [&](std::size_t i, const std::string& found) {
    const int channel = static_cast<int>(i % width);
    throw DataError(
        Place{file, "frame " + std::to_string(i / width) + ", " + channel_name(channel)},
        "found " + found + ", expected " + (channel == channels() ? "the separator" : "a bin") +
            " (token " + std::to_string(i) + "; a frame is " + std::to_string(channels()) +
            " bins and a separator)");
  };
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool separator = i % width == width - 1;
    if (separator ? ids[i] != kSeparator : !is_bin(ids[i])) refuse(i, describe(ids[i]));
  }
  if (ids.size() % width != 0) refuse(ids.size(), "the end");

  Clip clip;
  clip.name = name;
  clip.fps = config_.fps;
  const auto frames = static_cast<Eigen::Index>(ids.size() / width);
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = Translations(frames, 3);
  const bool turns = has_pelvis(joints_);
  Eigen::Vector3d position = start;
  for (Eigen::Index t = 0; t < frames; ++t) {
    const auto value = [&](int channel) {
      return bin_centre(
          channel,
          ids[static_cast<std::size_t>(t) * width + static_cast<std::size_t>(channel)] - kFirstBin);
    };
    for (int c = 0; c < rotation_channels(); ++c)
      clip.poses(t, 3 * channel_joint(c) + c % 3) = value(c);
    const int root = rotation_channels();
    if (config_.root == "absolute") position = {value(root), value(root + 1), value(root + 2)};
    if (config_.root == "steps") {
      const double yaw = turns ? heading(clip.poses.row(t).head<3>().transpose()) : 0;
      const Eigen::Vector2d way = to_floor({value(root), value(root + 2)}, yaw);
      position = {position.x() + way.x(), value(root + 1), position.z() + way.y()};
    }
    clip.trans.row(t) = position.transpose();
  }
  return clip;
}

}  // namespace mocaplm
