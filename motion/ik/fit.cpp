#include "motion/ik/fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "motion/ik/limb.h"
#include "motion/ik/trunk.h"
#include "motion/rotation.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Frames = std::vector<WorldRotations>;

struct LimbPoints {
  int parent, upper, lower, end, tip;  // joints: collar, shoulder, elbow, wrist, hand
  Vector3d hinge;
};

std::array<LimbPoints, 4> limbs() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  return {{{0, 1, 4, 7, 10, x},
           {0, 2, 5, 8, 11, x},
           {13, 16, 18, 20, 22, -y},
           {14, 17, 19, 21, 23, y}}};
}

// Directions of a bone over the whole clip; where it has no length, as before.
std::vector<Vector3d> directions(const PointTracks& tracks, int a, int b) {
  std::vector<Vector3d> all(static_cast<std::size_t>(tracks.frames()));
  Vector3d last = rest_bone(a, b).normalized();
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    all[static_cast<std::size_t>(t)] = last = direction(tracks, t, a, b, last);
  return all;
}

// `rotation` turned the shortest way so that the rest pose's `rest` points along `to`.
Quaterniond aimed(const Quaterniond& rotation, const Vector3d& rest, const Vector3d& to) {
  return (shortest_rotation(rotation * rest, to) * rotation).normalized();
}

void pose_limb(const PointTracks& tracks, const LimbPoints& limb, Frames& world) {
  const auto at = [](int joint) { return static_cast<std::size_t>(joint); };
  const std::vector<Vector3d> upper = directions(tracks, limb.upper, limb.lower),
                              lower = directions(tracks, limb.lower, limb.end);
  std::vector<Vector3d> seen_upper(upper.size()), seen_lower(upper.size());
  for (std::size_t t = 0; t < upper.size(); ++t) {
    const Quaterniond back = world[t][at(limb.parent)].conjugate();
    seen_upper[t] = (back * upper[t]).normalized();
    seen_lower[t] = (back * lower[t]).normalized();
  }
  const Vector3d rest_upper = rest_bone(limb.upper, limb.lower),
                 rest_lower = rest_bone(limb.lower, limb.end);
  const std::vector<Quaterniond> turned =
      limb_rotations({rest_upper.normalized(), rest_lower.normalized(), limb.hinge}, seen_upper,
                     seen_lower, tracks.fps);
  const int heel = limb.end == 7 ? kLeftHeel : limb.end == 8 ? kRightHeel : -1;
  const bool has_tip = tracks.has(limb.tip);
  const bool has_heel = heel >= 0 && tracks.has(heel) && has_tip;
  const std::vector<Vector3d> tip =
      has_tip ? directions(tracks, limb.end, limb.tip) : std::vector<Vector3d>();
  Vector3d sole = Vector3d::UnitZ();
  for (std::size_t t = 0; t < upper.size(); ++t) {
    WorldRotations& joints = world[t];
    joints[at(limb.upper)] = (joints[at(limb.parent)] * turned[t]).normalized();
    joints[at(limb.lower)] = aimed(joints[at(limb.upper)], rest_lower, lower[t]);
    Quaterniond& end = joints[at(limb.end)];
    end = joints[at(limb.lower)];
    if (has_heel) {
      // Heel and toes lie on the sole, which is level in the rest pose.
      sole = direction(tracks, static_cast<Eigen::Index>(t), heel, limb.tip, sole);
      const Vector3d toes = rest_bone(limb.end, limb.tip);
      end = aimed(end, Vector3d(toes.x(), 0, 2 * toes.z()), sole);
    } else if (has_tip) {
      end = aimed(end, rest_bone(limb.end, limb.tip), tip[t]);
    }
    joints[at(limb.tip)] = end;
  }
}

// The pelvis joint of the figure where the middle of its hips is at `hips`.
Vector3d pelvis_place(const Quaterniond& pelvis, const Vector3d& hips) {
  const Vector3d down = (rest_bone(0, 1) + rest_bone(0, 2)) / 2;
  return hips - pelvis * down;
}

void write_frame(const WorldRotations& world, const Vector3d& pelvis, Eigen::Index t, Clip& clip) {
  for (int j = 0; j < kJoints; ++j) {
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    const Quaterniond& own = world[static_cast<std::size_t>(j)];
    const Quaterniond local =
        parent < 0 ? own : world[static_cast<std::size_t>(parent)].conjugate() * own;
    clip.poses.row(t).segment<3>(3 * j) =
        axis_angle_from_quaternion(local.normalized()).transpose();
  }
  clip.trans.row(t) = pelvis.transpose() - rest_joints().row(0);
}

class Distances {
 public:
  void add(double metres, int point, Eigen::Index frame) {
    const double centimetres = 100 * metres;
    sum_ += centimetres * centimetres;
    ++count_;
    if (!(centimetres > residual_.worst)) return;
    residual_.worst = centimetres;
    residual_.worst_point = point;
    residual_.worst_frame = frame;
  }
  Residual residual() {
    if (count_ > 0) residual_.root_mean_square = std::sqrt(sum_ / static_cast<double>(count_));
    return residual_;
  }

 private:
  Residual residual_;
  double sum_ = 0;
  std::size_t count_ = 0;
};

// Both residuals. Bone by bone from the hips: where a joint would be if all bones above it pointed
// as the source's and had the figure's lengths.
void measure(const PointTracks& tracks, const TrunkPoints& points, PositionFit& fit) {
  std::array<bool, kJoints> counts{};
  for (int j = 0; j < kJoints; ++j) counts[static_cast<std::size_t>(j)] = tracks.has(j);
  // Joints of the same name that are other places.
  counts[0] = points.pelvis;
  counts[12] = counts[12] && points.neck;
  for (const int collar : {13, 14}) counts[static_cast<std::size_t>(collar)] = points.collars;
  // Toes and knuckles of other key points; beside a heel the sole decides, not the ankle's bone.
  for (const int tip : {10, 11, 22, 23}) counts[static_cast<std::size_t>(tip)] &= points.spine;
  counts[10] &= !tracks.has(kLeftHeel);
  counts[11] &= !tracks.has(kRightHeel);
  Distances from_bones, from_source;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) {
    const JointPositions posed = joint_positions(fit.clip, t);
    JointPositions wanted = posed;
    // Scaled about the middle of the hips, where figure and source meet.
    const Vector3d source_hips = tracks.middle(t, 1, 2),
                   hips = (posed.row(1) + posed.row(2)).transpose() / 2;
    for (int j = 0; j < kJoints; ++j) {
      if (!counts[static_cast<std::size_t>(j)]) continue;
      const Vector3d place = hips + fit.scale * (tracks.at(t, j) - source_hips);
      from_source.add((posed.row(j).transpose() - place).norm(), j, t);
      const int parent = joint_parents()[static_cast<std::size_t>(j)];
      if (parent < 0 || !counts[static_cast<std::size_t>(parent)]) continue;
      const Vector3d bone = rest_bone(parent, j);
      wanted.row(j) = wanted.row(parent) +
                      bone.norm() * direction(tracks, t, parent, j, bone.normalized()).transpose();
      from_bones.add((posed.row(j) - wanted.row(j)).norm(), j, t);
    }
  }
  fit.from_bones = from_bones.residual();
  fit.from_source = from_source.residual();
}

}  // namespace

PositionFit fit_positions(const PointTracks& tracks, double unit, bool keep_path) {
  PositionFit fit;
  fit.scale = smpl_measure().leg() / measure_body(tracks).leg();
  const double path = keep_path ? unit : fit.scale;
  const TrunkPoints points = trunk_points(tracks);
  fit.pelvis_is_middle = points.pelvis_is_middle;
  WorldRotations none;
  none.fill(Quaterniond::Identity());
  Frames world(static_cast<std::size_t>(tracks.frames()), none);
  for (std::size_t t = 0; t < world.size(); ++t)
    pose_trunk(tracks, points, static_cast<Eigen::Index>(t), t > 0 ? &world[t - 1] : nullptr,
               world[t]);
  for (const LimbPoints& limb : limbs()) pose_limb(tracks, limb, world);
  fit.clip.fps = tracks.fps;
  fit.clip.poses.resize(tracks.frames(), 72);
  fit.clip.trans.resize(tracks.frames(), 3);
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) {
    const WorldRotations& joints = world[static_cast<std::size_t>(t)];
    write_frame(joints, pelvis_place(joints[0], path * tracks.middle(t, 1, 2)), t, fit.clip);
  }
  measure(tracks, points, fit);
  return fit;
}

}  // namespace mocaplm
