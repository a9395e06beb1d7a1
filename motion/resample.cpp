#include "motion/resample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/taylor.h"

namespace mocaplm {

namespace {

// Two times this close (in source frames) are the same frame: 119.99999999 / 60 takes every second
// one.
constexpr double kSameFrame = 1e-7;
constexpr double kMaxResampled = 2e6;

using FrameQuaternions = std::array<Eigen::Quaterniond, kJoints>;

const std::vector<int>& all_joints() {
  static const std::vector<int> joints = parse_joints({"all"});
  return joints;
}

void read_frame(const Clip& clip, Eigen::Index frame, const std::vector<int>& joints,
                FrameQuaternions& out) {
  for (const int j : joints)
    out[static_cast<std::size_t>(j)] =
        quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
}

// The square of the angle between two unit vectors whose tips are d = |a - b| apart, of d^2 <=
// 1/64: 4 asin(d / 2)^2 by its series, to the last bit.
double squared_angle(double d2) {
  constexpr double kSquaredArc[] = {1,          1.0 / 12,    1.0 / 90,   1.0 / 560,
                                    1.0 / 3150, 1.0 / 16632, 1.0 / 84084};
  return d2 * series<7>(kSquaredArc, d2);
}

// sin(x) / x of z = x^2 <= 1/64, to the last bit.
double small_sinc(double z) {
  return series<5>(kSinc, z);
}

// Slerp along the shorter arc: weights sin((1 - t) theta) / sin(theta) and sin(t theta) /
// sin(theta). The angle comes from |a - b| and |a + b|, which are precise at both ends, where the
// arc cosine of the dot product is not.
Eigen::Quaterniond between(const Eigen::Quaterniond& a, Eigen::Quaterniond b, double t) {
  if (a.dot(b) < 0) b.coeffs() = -b.coeffs();
  const double apart = (a.coeffs() - b.coeffs()).squaredNorm();
  double from, to;
  if (apart <= 1.0 / 64) {  // nearly always: neighbouring frames within 14 degrees
    const double z = squared_angle(apart), scale = 1 / small_sinc(z);
    from = (1 - t) * small_sinc((1 - t) * (1 - t) * z) * scale;
    to = t * small_sinc(t * t * z) * scale;
  } else {
    const double theta = 2 * std::atan2(std::sqrt(apart), (a.coeffs() + b.coeffs()).norm());
    const double sine = std::sin(theta);
    from = std::sin((1 - t) * theta) / sine;
    to = std::sin(t * theta) / sine;
  }
  return Eigen::Quaterniond(from * a.coeffs() + to * b.coeffs());
}

// The number of frames at `fps` that fit between the first and the last frame of the clip.
Eigen::Index frames_at(const Clip& clip, double fps) {
  const double last = static_cast<double>(clip.frames() - 1);
  const double count = std::floor((last + kSameFrame) * (fps / clip.fps)) + 1;
  if (count > kMaxResampled && fps > clip.fps)
    throw UsageError("\"" + clip.name + "\" at " + format_number(fps) + " frames per second has " +
                     format_number(count) + " frames, more than " + format_number(kMaxResampled) +
                     ": ask for a lower rate");
  return static_cast<Eigen::Index>(count);
}

Clip take_every(const Clip& clip, Eigen::Index step, double fps) {
  Clip out;
  out.name = clip.name;
  out.labels = clip.labels;
  out.body = clip.body;
  out.fps = fps;
  const Eigen::Index count = (clip.frames() + step - 1) / step;
  out.poses.resize(count, 72);
  out.trans.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    out.poses.row(i) = clip.poses.row(i * step);
    out.trans.row(i) = clip.trans.row(i * step);
  }
  return out;
}

// Source frames `first` and `first + 1` as quaternions, each converted once while walking forward.
class Window {
 public:
  Window(const Clip& clip, const std::vector<int>& joints) : clip_(clip), joints_(joints) {}
  void move_to(Eigen::Index first) {
    if (first == first_) return;
    if (first == first_ + 1)
      std::swap(left_, right_);
    else
      read_frame(clip_, first, joints_, left_);
    read_frame(clip_, first + 1, joints_, right_);
    first_ = first;
  }
  const Eigen::Quaterniond& left(int joint) const { return left_[static_cast<std::size_t>(joint)]; }
  const Eigen::Quaterniond& right(int joint) const {
    return right_[static_cast<std::size_t>(joint)];
  }

 private:
  const Clip& clip_;
  const std::vector<int>& joints_;
  Eigen::Index first_ = -2;
  FrameQuaternions left_, right_;
};

}  // namespace

Clip resample(const Clip& clip, double fps) {
  return resample(clip, fps, all_joints());
}

Clip resample(const Clip& clip, double fps, const std::vector<int>& joints) {
  if (!(fps > 0 && fps <= 10000))
    throw UsageError("cannot resample to " + format_number(fps) +
                     " frames per second; expected more than 0, at most 10000");
  assert(clip.frames() > 0 && clip.fps > 0);
  const double ratio = clip.fps / fps;
  const double step = std::round(ratio);
  if (step >= 1 && std::abs(ratio - step) * static_cast<double>(clip.frames()) < kSameFrame * step)
    return take_every(clip, static_cast<Eigen::Index>(step), fps);

  Clip out;
  out.name = clip.name;
  out.labels = clip.labels;
  out.body = clip.body;
  out.fps = fps;
  const Eigen::Index count = frames_at(clip, fps);
  out.poses.resize(count, 72);
  if (joints.size() < kJoints) out.poses.setZero();
  out.trans.resize(count, 3);
  Window window(clip, joints);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double position = static_cast<double>(i) * ratio;
    const auto nearest =
        std::min(static_cast<Eigen::Index>(std::llround(position)), clip.frames() - 1);
    if (clip.frames() == 1 || std::abs(position - static_cast<double>(nearest)) < kSameFrame) {
      for (const int j : joints)
        out.poses.row(i).segment<3>(3 * j) = clip.poses.row(nearest).segment<3>(3 * j);
      out.trans.row(i) = clip.trans.row(nearest);
      continue;
    }
    const auto first = std::min(static_cast<Eigen::Index>(position), clip.frames() - 2);
    const double t = position - static_cast<double>(first);
    window.move_to(first);
    for (const int j : joints)
      out.poses.row(i).segment<3>(3 * j) =
          axis_angle_from_quaternion(between(window.left(j), window.right(j), t)).transpose();
    out.trans.row(i) = (1 - t) * clip.trans.row(first) + t * clip.trans.row(first + 1);
  }
  keep_continuous(out, kPi);
  return out;
}

void keep_continuous(Clip& clip, double limit) {
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const double* before = clip.poses.row(std::max<Eigen::Index>(t - 1, 0)).data();
    for (int j = 0; j < kJoints; ++j) {
      auto cell = clip.poses.row(t).segment<3>(3 * j);
      const Eigen::Vector3d v = cell.transpose(), previous(before + 3 * j);
      // The other vectors of this rotation are a multiple of 2 pi away from v, so within pi of the
      // previous frame v is the nearest one.
      const bool follows =
          v.cwiseAbs().maxCoeff() <= limit && (v - previous).squaredNorm() <= kPi * kPi;
      if (!follows) cell = continuous_axis_angle(v, previous, limit).transpose();
    }
  }
}

}  // namespace mocaplm
