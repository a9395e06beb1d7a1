#include "motion/formats/bvh.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "common/angles.h"
#include "motion/taylor.h"

namespace mocaplm {

namespace {

std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

double double_of(std::uint64_t bits) {
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

struct SinCos {
  double sine, cosine;
};

// Sine and cosine of an angle of at most 1e7 degrees. Whole quarter turns are taken off in degrees,
// which is exact; of what is left, at most 45 degrees, the Taylor series to the powers 15 and 16
// are within 1e-16. Without branches and tables: which quarter it is cannot be foreseen.
SinCos sin_cos_degrees(double degrees) {
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to a whole number
  const double shifted = degrees * (1.0 / 90) + kRound;
  const double x = (degrees - 90 * (shifted - kRound)) * kRadians, z = x * x;
  const double sine = x * series<8>(kSinc, z), cosine = series<9>(kCosine, z);
  // The last bits of `shifted` count the quarter turns: odd ones swap sine and cosine.
  const std::uint64_t turns = bits_of(shifted), odd = 0 - (turns & 1);
  const std::uint64_t s = bits_of(sine), c = bits_of(cosine), differ = (s ^ c) & odd;
  return {double_of(s ^ differ ^ (turns & 2) << 62),
          double_of(c ^ differ ^ ((turns + 1) & 2) << 62)};
}

// rotation * R(axis, angle), which only mixes the two other columns.
void rotate(Eigen::Matrix3d& rotation, int axis, double degrees) {
  const auto [s, c] = sin_cos_degrees(degrees);
  double* u = rotation.data() + 3 * ((axis + 1) % 3);
  double* v = rotation.data() + 3 * ((axis + 2) % 3);
  for (int i = 0; i < 3; ++i) {
    const double a = u[i], b = v[i];
    u[i] = c * a + s * b;
    v[i] = c * b - s * a;
  }
}

// One joint; its parent must have been posed.
void pose_joint(const Bvh& bvh, const double* values, std::size_t i, BvhPose& pose) {
  const BvhJoint& joint = bvh.joints[i];
  Eigen::Matrix3d& rotation = pose.rotations[i];
  const auto parent = static_cast<std::size_t>(joint.parent);
  if (joint.parent < 0)
    rotation.setIdentity();
  else
    rotation = pose.rotations[parent];
  Eigen::Vector3d position = joint.offset;
  const double* value = values + joint.first_channel;
  for (const BvhChannel channel : joint.channels) {
    const int kind = static_cast<int>(channel);
    if (kind < 3)
      position[kind] = *value++;
    else
      rotate(rotation, kind - 3, *value++);
  }
  if (joint.parent >= 0) position = pose.positions[parent] + pose.rotations[parent] * position;
  pose.positions[i] = position;
}

}  // namespace

int Bvh::joint(const std::string& name) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == name) return static_cast<int>(i);
  return -1;
}

void pose_bvh_values(const Bvh& bvh, const double* values, BvhPose& pose) {
  pose.rotations.resize(bvh.joints.size());
  pose.positions.resize(bvh.joints.size());
  for (std::size_t i = 0; i < bvh.joints.size(); ++i) pose_joint(bvh, values, i, pose);
}

void pose_bvh(const Bvh& bvh, Eigen::Index frame, BvhPose& pose) {
  pose_bvh_values(bvh, bvh.values.row(frame).data(), pose);
}

void pose_bvh(const Bvh& bvh, Eigen::Index frame, const std::vector<std::size_t>& joints,
              BvhPose& pose) {
  pose.rotations.resize(bvh.joints.size());
  pose.positions.resize(bvh.joints.size());
  const double* values = bvh.values.row(frame).data();
  for (const std::size_t i : joints) pose_joint(bvh, values, i, pose);
}

std::vector<BvhPose> some_poses(const Bvh& bvh, const std::vector<std::size_t>& joints) {
  constexpr Eigen::Index kMostPoses = 24;
  const Eigen::Index step = std::max<Eigen::Index>(1, (bvh.frames() + kMostPoses - 1) / kMostPoses);
  std::vector<BvhPose> poses;
  for (Eigen::Index t = 0; t < bvh.frames(); t += step)
    pose_bvh(bvh, t, joints, poses.emplace_back());
  return poses;
}

BvhPose rest_bvh(const Bvh& bvh) {
  BvhPose pose;
  for (const BvhJoint& joint : bvh.joints) {
    pose.rotations.push_back(Eigen::Matrix3d::Identity());
    pose.positions.push_back(
        joint.parent < 0 ? joint.offset
                         : Eigen::Vector3d(pose.positions[static_cast<std::size_t>(joint.parent)] +
                                           joint.offset));
  }
  return pose;
}

}  // namespace mocaplm
