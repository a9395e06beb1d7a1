// Motion to tokens and back.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/root_motion.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kPelvis = 0;
// 14 hours at 20 frames per second: more comes from a wrong frame rate, and would not fit in
// memory.
constexpr double kMaxFrames = 1e6;

// Where the dancer stands and faces. Without the pelvis among the joints nobody who decodes knows
// the heading: then it is 0, and steps are along the world's axes.
class Walker {
 public:
  Walker(const std::vector<int>& joints, double x, double z)
      : turns_(std::find(joints.begin(), joints.end(), kPelvis) != joints.end()), at_(x, z) {}

  void face(const Eigen::Vector3d& pelvis) { yaw_ = turns_ ? heading(pelvis) : 0; }
  // (left, forward) to a place on the floor.
  Eigen::Vector2d step_to(double x, double z) const {
    return to_dancer({x - at_.x(), z - at_.y()}, yaw_);
  }
  void step(double left, double forward) { at_ += to_floor({left, forward}, yaw_); }
  void stand(double x, double z) { at_ = {x, z}; }
  double x() const { return at_.x(); }
  double z() const { return at_.y(); }

 private:
  bool turns_;
  Eigen::Vector2d at_;
  double yaw_ = 0;
};

}  // namespace

Clip Tokenizer::at_rate(const Clip& clip) const {
  const std::string name = clip.name.empty() ? "clip" : clip.name;
  check_clip(clip, name);
  if (std::abs(clip.fps - config_.fps) < 1e-9) return clip;
  if (clip.seconds() * config_.fps > kMaxFrames)
    throw DataError(in_file(name), "lasts " + format_duration(clip.seconds()) + " by its rate of " +
                                       format_number(clip.fps) +
                                       " frames per second, which is too long; is the rate right?");
  return resample(clip, config_.fps);
}

bool Tokenizer::is_decoded(const Eigen::Vector3d& v, int first) const {
  for (int axis = 0; axis < 3; ++axis) {
    const int c = first + axis;
    if (std::abs(v[axis] - bin_centre(c, bin_of(c, v[axis]))) > 1e-12) return false;
  }
  return true;
}

Eigen::MatrixXd Tokenizer::channel_values(const Clip& given) const {
  const Clip clip = at_rate(given);
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
  if (config_.root == "absolute") values.rightCols<3>() = clip.trans;
  if (config_.root == "steps") {
    Walker walker(joints_, clip.trans(0, 0), clip.trans(0, 2));
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      walker.face(clip.poses.row(t).head<3>().transpose());
      const Eigen::Vector2d step = walker.step_to(clip.trans(t, 0), clip.trans(t, 2));
      values.row(t).tail<3>() << step.x(), clip.trans(t, 1), step.y();
      walker.stand(clip.trans(t, 0), clip.trans(t, 2));
    }
  }
  return values;
}

TokenStream Tokenizer::encode(const Clip& given, EncodeReport* report) const {
  const Clip clip = at_rate(given);
  Eigen::MatrixXd values = channel_values(clip);
  const int root = rotation_channels();
  TokenStream stream;
  stream.reserve(static_cast<std::size_t>(values.rows() * tokens_per_frame()));
  EncodeReport counts;
  counts.values = values.size();
  const auto quantise = [&](Eigen::Index t, int c) {
    bool clamped = false;
    const int bin = bin_of(c, values(t, c), &clamped);
    counts.clamped += clamped;
    stream.push(kFirstBin + bin, static_cast<std::int32_t>(t), c);
    return bin_centre(c, bin);
  };
  // Where the decoder believes the dancer to be: a step is measured from there and in the decoded
  // heading, so that rounding never adds up.
  Walker believed(joints_, clip.trans(0, 0), clip.trans(0, 2));
  for (Eigen::Index t = 0; t < values.rows(); ++t) {
    Eigen::Vector3d pelvis;  // decoded; the pelvis is the first joint where it is one at all
    for (int c = 0; c < root; ++c) {
      const double decoded = quantise(t, c);
      if (c < 3) pelvis[c] = decoded;
    }
    if (config_.root == "steps") {
      believed.face(pelvis);
      const Eigen::Vector2d step = believed.step_to(clip.trans(t, 0), clip.trans(t, 2));
      values(t, root) = step.x();
      values(t, root + 2) = step.y();
    }
    if (config_.root != "none") {
      const double left = quantise(t, root);
      quantise(t, root + 1);
      believed.step(left, quantise(t, root + 2));
    }
    stream.push(kSeparator, static_cast<std::int32_t>(t), channels());
  }
  if (report) {
    report->values += counts.values;
    report->clamped += counts.clamped;
  }
  return stream;
}

void Tokenizer::check_frames(const std::vector<std::int32_t>& ids, const std::string& name) const {
  const auto width = static_cast<std::size_t>(tokens_per_frame());
  if (ids.empty())
    throw DataError(in_file(name),
                    "holds no tokens, expected whole frames of " + std::to_string(width));
  const auto refuse = [&](std::size_t i, const std::string& found) {
    const int channel = static_cast<int>(i % width);
    throw DataError(
        Place{name, "frame " + std::to_string(i / width) + ", " + channel_name(channel)},
        "found " + found + ", expected " + (channel == channels() ? "the separator" : "a bin") +
            " (token " + std::to_string(i) + "; a frame is " + std::to_string(channels()) +
            " bins and a separator)");
  };
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool separator = i % width == width - 1;
    if (separator ? ids[i] != kSeparator : !is_bin(ids[i])) refuse(i, describe(ids[i]));
  }
  if (ids.size() % width != 0) refuse(ids.size(), "the end");
}

Clip Tokenizer::decode(const std::vector<std::int32_t>& ids, const std::string& name,
                       const Eigen::Vector3d& start) const {
  check_frames(ids, name.empty() ? "token stream" : name);
  const Eigen::Index width = tokens_per_frame(), root = rotation_channels();
  Clip clip;
  clip.name = name;
  clip.fps = config_.fps;
  const Eigen::Index frames = static_cast<Eigen::Index>(ids.size()) / width;
  clip.poses = Poses::Zero(frames, 72);
  clip.trans = start.transpose().replicate(frames, 1);
  Walker walker(joints_, start.x(), start.z());
  Eigen::VectorXd values(channels());
  for (Eigen::Index t = 0; t < frames; ++t) {
    for (int c = 0; c < channels(); ++c)
      values[c] = bin_centre(c, ids[static_cast<std::size_t>(t * width + c)] - kFirstBin);
    for (int c = 0; c < root; ++c) clip.poses(t, 3 * channel_joint(c) + c % 3) = values[c];
    if (config_.root == "absolute") clip.trans.row(t) = values.tail<3>().transpose();
    if (config_.root == "steps") {
      walker.face(clip.poses.row(t).head<3>().transpose());
      walker.step(values[root], values[root + 2]);
      clip.trans.row(t) << walker.x(), values[root + 1], walker.z();
    }
  }
  return clip;
}

}  // namespace mocaplm
