// Motion to tokens and back.
#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/root_motion.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

constexpr int kPelvis = 0;
// A vector this close to the frame before is its continuation: the other vectors of its rotation
// are whole turns away.
constexpr double kHalfTurn = kPi - 1e-6;
// 14 hours at 20 frames per second: more comes from a wrong frame rate, and would not fit in
// memory.
constexpr double kMaxFrames = 1e6;

// Where the dancer stands and faces. Without the pelvis among the joints nobody who decodes knows
// the heading: then it is 0, and steps are along the world's axes.
class Walker {
 public:
  Walker(const std::vector<int>& joints, double x, double z)
      : turns_(std::find(joints.begin(), joints.end(), kPelvis) != joints.end()), at_(x, z) {}

  void face(const Eigen::Vector3d& pelvis) {
    if (turns_) front_ = heading_direction(pelvis);
  }
  // (left, forward) to a place on the floor.
  Eigen::Vector2d step_to(double x, double z) const {
    return to_dancer({x - at_.x(), z - at_.y()}, front_);
  }
  void step(double left, double forward) { at_ += to_floor({left, forward}, front_); }
  void stand(double x, double z) { at_ = {x, z}; }
  double x() const { return at_.x(); }
  double z() const { return at_.y(); }

 private:
  bool turns_;
  Eigen::Vector2d at_;
  Eigen::Vector2d front_{0, 1};  // (x, z), of unit length
};

}  // namespace

bool Tokenizer::check_rate(const Clip& clip) const {
  const std::string name = clip.name.empty() ? "clip" : clip.name;
  check_clip(clip, name);
  if (std::abs(clip.fps - config_.fps) < 1e-9) return true;
  if (clip.seconds() * config_.fps > kMaxFrames)
    throw DataError(in_file(name), "lasts " + format_duration(clip.seconds()) + " by its rate of " +
                                       format_number(clip.fps) +
                                       " frames per second, which is too long; is the rate right?");
  return false;
}

Clip Tokenizer::at_rate(const Clip& clip) const {
  return check_rate(clip) ? clip : resample(clip, config_.fps);
}

const Clip& Tokenizer::at_rate(const Clip& clip, Clip& resampled) const {
  if (check_rate(clip)) return clip;
  return resampled = resample(clip, config_.fps, joints_);
}

bool Tokenizer::is_decoded(const Eigen::Vector3d& v, int first) const {
  for (int axis = 0; axis < 3; ++axis) {
    const int c = first + axis;
    if (std::abs(v[axis] - bin_centre(c, bin_of(c, v[axis]))) > 1e-12) return false;
  }
  return true;
}

void Tokenizer::next_rotations(const Clip& clip, Eigen::Index frame,
                               std::vector<double>& values) const {
  const double* poses = clip.poses.row(frame).data();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Eigen::Vector3d v(poses + 3 * joints_[i]);
    Eigen::Map<Eigen::Vector3d> cell(values.data() + 3 * i);
    const bool follows = frame > 0 && v.cwiseAbs().maxCoeff() <= kPi &&
                         (v - cell).squaredNorm() <= kHalfTurn * kHalfTurn;
    Eigen::Vector3d next = v;
    if (!follows && !is_decoded(v, static_cast<int>(3 * i)))
      next = frame == 0 ? axis_angle_from_quaternion(quaternion_from_axis_angle(v))
                        : continuous_axis_angle(v, cell, kPi);
    // Rounding must not push a component past the outermost bin.
    cell = next.cwiseMax(-kPi).cwiseMin(kPi);
  }
}

Tokenizer::Rotations Tokenizer::rotation_values(const Clip& given) const {
  Clip resampled;
  const Clip& clip = at_rate(given, resampled);
  Rotations values(clip.frames(), rotation_channels());
  std::vector<double> rotations(static_cast<std::size_t>(rotation_channels()));
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    next_rotations(clip, t, rotations);
    std::copy(rotations.begin(), rotations.end(), values.row(t).data());
  }
  return values;
}

Eigen::MatrixXd Tokenizer::channel_values(const Clip& given) const {
  Clip resampled;
  const Clip& clip = at_rate(given, resampled);
  Eigen::MatrixXd values(clip.frames(), channels());
  values.leftCols(rotation_channels()) = rotation_values(clip);
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
  Clip resampled;
  const Clip& clip = at_rate(given, resampled);
  const int root = rotation_channels();
  const bool steps = config_.root == "steps", none = config_.root == "none";
  const auto size = static_cast<std::size_t>(clip.frames() * tokens_per_frame());
  TokenStream stream;
  stream.ids.resize(size);
  stream.frame.resize(size);
  stream.channel.resize(size);
  std::size_t next = 0;
  EncodeReport outside;
  const auto push = [&](std::int32_t id, Eigen::Index t, int c) {
    stream.ids[next] = id;
    stream.frame[next] = static_cast<std::int32_t>(t);
    stream.channel[next++] = c;
  };
  const auto quantise = [&](Eigen::Index t, int c, double value) {
    if (const double beyond = this->beyond(c, value); beyond > 0) {
      ++outside.clamped;
      double& farthest = c < root ? outside.farthest_rotation : outside.farthest_root;
      farthest = std::max(farthest, beyond);
    }
    const int bin = bin_of(c, value);
    push(kFirstBin + bin, t, c);
    return bin_centre(c, bin);
  };
  // Where the decoder believes the dancer to be: a step is measured from there and in the decoded
  // heading, so that rounding never adds up.
  Walker believed(joints_, clip.trans(0, 0), clip.trans(0, 2));
  std::vector<double> rotations(static_cast<std::size_t>(root));
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    next_rotations(clip, t, rotations);
    Eigen::Vector3d pelvis;  // decoded; the pelvis is the first joint where it is one at all
    for (int c = 0; c < root; ++c) {
      const double decoded = quantise(t, c, rotations[static_cast<std::size_t>(c)]);
      if (c < 3) pelvis[c] = decoded;
    }
    if (!none) {
      Eigen::Vector3d way = clip.trans.row(t).transpose();
      if (steps) {
        believed.face(pelvis);
        const Eigen::Vector2d step = believed.step_to(way.x(), way.z());
        way.x() = step.x();
        way.z() = step.y();
      }
      const double left = quantise(t, root, way.x());
      quantise(t, root + 1, way.y());
      believed.step(left, quantise(t, root + 2, way.z()));
    }
    push(kSeparator, t, channels());
  }
  outside.values = static_cast<std::int64_t>(size) - clip.frames();
  if (report) report->add(outside);
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
