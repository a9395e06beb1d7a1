#include "motion/formats/retarget.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/retarget_map.h"
#include "motion/formats/retarget_stance.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kHalfTurn = kPi - 1e-6;  // with room for rounding

// A bone from a joint to its child, by SMPL index.
struct Bone {
  const char* name;
  std::size_t joint, child;
};
// Bones whose directions are kept exactly and reported.
constexpr Bone kLimbs[] = {{"left_upper_arm", 16, 18},  {"left_lower_arm", 18, 20},
                           {"right_upper_arm", 17, 19}, {"right_lower_arm", 19, 21},
                           {"left_upper_leg", 1, 4},    {"left_lower_leg", 4, 7},
                           {"right_upper_leg", 2, 5},   {"right_lower_leg", 5, 8}};
// The spine from pelvis to head: joints without a source share the turn between their neighbours.
constexpr std::size_t kSpine[] = {0, 3, 6, 9, 12, 15};

using Rotations = std::array<Eigen::Quaterniond, kJoints>;

Eigen::Vector3d rest(std::size_t joint) {
  return rest_joints().row(static_cast<Eigen::Index>(joint)).transpose();
}

// The joints of the file that SMPL's joints come from, and all above them, ascending.
std::vector<std::size_t> with_ancestors(const Bvh& bvh, const SourceJoints& joints) {
  std::vector<bool> needed(bvh.joints.size(), false);
  for (int joint : joints)
    for (; joint >= 0; joint = bvh.joints[static_cast<std::size_t>(joint)].parent)
      needed[static_cast<std::size_t>(joint)] = true;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < needed.size(); ++i)
    if (needed[i]) indices.push_back(i);
  return indices;
}

class Retargeter {
 public:
  Retargeter(const Bvh& bvh, const RetargetMap& map, const BvhOptions& options,
             const std::string& file)
      : bvh_(bvh),
        map_(map),
        joints_(source_joints(bvh, map, file)),
        needed_(with_ancestors(bvh, joints_)),
        turn_(world_turn(bvh, map, options.up, file)),
        turn_quaternion_(quaternion_from_matrix(turn_)),
        from_t_pose_(from_t_pose(bvh, map, joints_, turn_, file)),
        hands_{hand_in_t_pose(20, 18), hand_in_t_pose(21, 19)} {
    for (std::size_t j = 0; j < kJoints; ++j)
      from_t_pose_quaternions_[j] = quaternion_from_matrix(from_t_pose_[j]);
    unit_ = find_unit(options);
    const double height = figure_height(bvh_, joints_) * unit_;
    if (!(height > 0.3 && height < 5))
      throw DataError(in_file(file), "the figure would be " + format_number(height) +
                                         " m tall at " + format_number(unit_) +
                                         " m per unit; give the unit");
  }

  double unit() const { return unit_; }
  double height() const { return figure_height(bvh_, joints_) * unit_; }
  // True when the source turns this joint. A hand's joint only says where the wrist points.
  bool has(std::size_t joint) const { return joints_[joint] >= 0 && !(map_.align && joint >= 22); }
  // The direction of a bone of the source in the frame last converted, in our world; not of unit
  // length.
  Eigen::Vector3d bone(const Bone& b) const { return position(b.child) - position(b.joint); }

  // World rotations of SMPL's joints in one frame, and where its pelvis joint lies, metres.
  Eigen::Vector3d convert(Eigen::Index frame, Rotations& world) {
    pose_bvh(bvh_, frame, needed_, pose_);
    for (std::size_t j = 0; j < kJoints; ++j)
      if (has(j))
        world[j] =
            turn_quaternion_ * quaternion_from_matrix(source(j)) * from_t_pose_quaternions_[j];
    if (map_.align) {
      for (const Bone& limb : kLimbs) align(limb, bone(limb), world);
      for (std::size_t side = 0; side < 2; ++side) align_wrist(side, world);
    }
    fill_spine(world);
    for (std::size_t j = 1; j < kJoints; ++j)
      if (!has(j) && std::find(std::begin(kSpine), std::end(kSpine), j) == std::end(kSpine))
        world[j] = world[static_cast<std::size_t>(joint_parents()[j])];
    const Eigen::Vector3d hips = 0.5 * unit_ * (position(1) + position(2));
    return hips - world[0] * (0.5 * (rest(1) + rest(2)) - rest(0));
  }

 private:
  const Eigen::Matrix3d& source(std::size_t joint) const {
    return pose_.rotations[static_cast<std::size_t>(joints_[joint])];
  }
  Eigen::Vector3d position(std::size_t joint) const {
    return turn_ * pose_.positions[static_cast<std::size_t>(joints_[joint])];
  }

  double find_unit(const BvhOptions& options) const {
    if (options.unit) return *options.unit;
    if (map_.unit) return *map_.unit;
    const double height = figure_height(bvh_, joints_);
    if (height < 3) return 1;  // metres
    // The original CMU files: 1/0.45 of an inch.
    if (height > 20 && height < 45 && (map_.scheme == "cmu" || map_.scheme == "motionbuilder"))
      return 0.0254 / 0.45;
    return height > 600 ? 0.001 : 0.01;
  }

  // Turns the bone's joint by the smallest rotation that brings SMPL's bone into the direction
  // `to`.
  static void align(const Bone& bone, const Eigen::Vector3d& to, Rotations& world) {
    if (to.norm() < 1e-9) return;
    const Eigen::Vector3d from = world[bone.joint] * (rest(bone.child) - rest(bone.joint));
    world[bone.joint] = (shortest_rotation(from, to) * world[bone.joint]).normalized();
  }
  void align_wrist(std::size_t side, Rotations& world) const {
    const Bone hand = {"", 20 + side, 22 + side};
    align(hand, joints_[hand.child] >= 0 ? bone(hand) : world[hand.joint] * hands_[side], world);
  }
  // Where a hand without a joint of its own points in the T-pose: to its End Site, else straight to
  // the side, else (the zero pose may be an A-pose) on along the forearm.
  Eigen::Vector3d hand_in_t_pose(std::size_t wrist, std::size_t elbow) {
    pose_bvh(bvh_, Eigen::Index{0}, pose_);
    const Eigen::Vector3d forearm = bone({"", elbow, wrist});
    const auto& ends = bvh_.joints[static_cast<std::size_t>(joints_[wrist])].end_sites;
    if (!ends.empty() && ends.front().norm() > 0.01 * forearm.norm())
      return from_t_pose_[wrist].transpose() * ends.front();
    if (map_.t_pose != TPose::zero) return (wrist == 20 ? 1 : -1) * Eigen::Vector3d::UnitX();
    return from_t_pose_[elbow].transpose() * source(elbow).transpose() * turn_.transpose() *
           forearm;
  }

  // Between two joints that have a source the turn is shared equally; above the last one they
  // follow it.
  void fill_spine(Rotations& world) const {
    constexpr std::size_t n = std::size(kSpine);
    for (std::size_t i = 1, last = 0; i < n; ++i) {
      if (has(kSpine[i])) {
        for (std::size_t k = last + 1; k < i; ++k)
          world[kSpine[k]] = world[kSpine[last]].slerp(
              static_cast<double>(k - last) / static_cast<double>(i - last), world[kSpine[i]]);
        last = i;
      } else {
        world[kSpine[i]] = world[kSpine[last]];
      }
    }
  }

  const Bvh& bvh_;
  const RetargetMap& map_;
  SourceJoints joints_;
  std::vector<std::size_t> needed_;  // the file's joints that have a part in the result
  Eigen::Matrix3d turn_;
  Eigen::Quaterniond turn_quaternion_;
  std::array<Eigen::Matrix3d, kJoints> from_t_pose_;
  Rotations from_t_pose_quaternions_;
  double unit_ = 0;
  BvhPose pose_;
  std::array<Eigen::Vector3d, 2> hands_;
};

// Local rotation vectors of one frame, each the continuation of the frame before where that fits in
// pi.
void set_poses(Clip& clip, Eigen::Index frame, const Rotations& world,
               const Retargeter& retargeter) {
  for (int j = 0; j < kJoints; ++j) {
    const auto joint = static_cast<std::size_t>(j);
    const int parent = joint_parents()[joint];
    if (parent >= 0 && !retargeter.has(joint) && mirrored_joints()[joint] != j)
      continue;  // follows: zero
    const Eigen::Quaterniond local =
        parent < 0 ? world[0] : world[static_cast<std::size_t>(parent)].conjugate() * world[joint];
    Eigen::Vector3d v = axis_angle_from_quaternion(local);
    if (frame > 0) {
      const Eigen::Vector3d previous = clip.poses.row(frame - 1).segment<3>(3 * j).transpose();
      // The other vectors of this rotation are whole turns away: within half a turn it is nearest.
      if ((v - previous).squaredNorm() > kHalfTurn * kHalfTurn)
        v = continuous_axis_angle(v, previous, kPi);
    }
    clip.poses.row(frame).segment<3>(3 * j) = v.transpose();
  }
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi;
}

// SMPL's joints whose rotations turn a limb, each after its parent.
constexpr int kLimbChain[] = {0, 1, 2, 3, 4, 5, 6, 9, 13, 14, 16, 17, 18, 19};

// Adds one frame's limb errors, measured through the forward kinematics of the clip's own numbers.
void measure(const Clip& clip, Eigen::Index frame, const Retargeter& retargeter,
             RetargetReport& report) {
  Rotations world;
  for (const int j : kLimbChain) {
    const auto joint = static_cast<std::size_t>(j);
    const int parent = joint_parents()[joint];
    const Eigen::Quaterniond local =
        quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
    world[joint] = parent < 0 ? local : world[static_cast<std::size_t>(parent)] * local;
  }
  for (std::size_t i = 0; i < std::size(kLimbs); ++i) {
    const Bone& limb = kLimbs[i];
    const Eigen::Vector3d source = retargeter.bone(limb);
    if (source.norm() < 1e-9) continue;
    const Eigen::Vector3d ours = world[limb.joint] * (rest(limb.child) - rest(limb.joint));
    const double error = degrees_between(source, ours);
    report.limbs[i].mean += error;
    ++report.limbs[i].frames;
    if (error > report.limbs[i].max) {
      report.limbs[i].max = error;
      report.limbs[i].worst_frame = frame;
    }
  }
}

void start(RetargetReport& report, const RetargetMap& map, const Retargeter& retargeter) {
  report = RetargetReport();
  report.scheme = map.scheme;
  report.unit = retargeter.unit();
  report.height = retargeter.height();
  for (const Bone& limb : kLimbs) report.limbs.push_back({limb.name});
  for (std::size_t j = 0; j < kJoints; ++j)
    if (!retargeter.has(j)) report.unmatched.push_back(joint_names()[j]);
}

// Turns the sums into means; limbs that never had a length are left out.
void finish(RetargetReport& report) {
  auto& limbs = report.limbs;
  limbs.erase(std::remove_if(limbs.begin(), limbs.end(),
                             [](const LimbError& limb) { return limb.frames == 0; }),
              limbs.end());
  for (LimbError& limb : limbs) {
    limb.mean /= static_cast<double>(limb.frames);
    report.mean_degrees += limb.mean / static_cast<double>(limbs.size());
    report.max_degrees = std::max(report.max_degrees, limb.max);
  }
}

void check(const BvhOptions& options) {
  if (options.fps && !(*options.fps > 0 && *options.fps <= 10000))
    throw UsageError("frame rate " + format_number(*options.fps) +
                     ", expected between 0 and 10000 per second");
  if (options.unit && !(*options.unit >= 1e-6 && *options.unit <= 1e6))
    throw UsageError("unit " + format_number(*options.unit) +
                     ", expected metres per unit of the file, 1e-6 to 1e6");
}

}  // namespace

Clip retarget_bvh(const Bvh& bvh, const RetargetMap& map, const std::string& file,
                  const BvhOptions& options, RetargetReport* report) {
  check(options);
  if (bvh.frames() == 0) throw DataError(in_file(file), "has no frames");
  Retargeter retargeter(bvh, map, options, file);
  Clip clip;
  clip.name = std::filesystem::path(file).stem().string();
  clip.fps = options.fps.value_or(bvh.fps);
  clip.poses.setZero(bvh.frames(), 72);
  clip.trans.resize(bvh.frames(), 3);
  if (report) start(*report, map, retargeter);
  Rotations world;
  for (Eigen::Index t = 0; t < bvh.frames(); ++t) {
    const Eigen::Vector3d pelvis = retargeter.convert(t, world);
    clip.trans.row(t) = (pelvis - rest(0)).transpose();
    set_poses(clip, t, world, retargeter);
    if (report) measure(clip, t, retargeter, *report);
  }
  if (report) finish(*report);
  check_clip(clip, file);
  return clip;
}

Clip retarget_bvh(const Bvh& bvh, const std::string& file, const BvhOptions& options,
                  RetargetReport* report) {
  const RetargetMap map =
      options.map_file.empty() ? detect_map(bvh, file) : load_map(options.map_file);
  return retarget_bvh(bvh, map, file, options, report);
}

Clip read_bvh_clip(const std::filesystem::path& path, const BvhOptions& options,
                   RetargetReport* report) {
  const Bvh bvh = read_bvh(path, {options.fill_gaps, options.fps});
  Clip clip = retarget_bvh(bvh, path.string(), options, report);
  if (report)
    report->remarks.insert(report->remarks.begin(), bvh.remarks.begin(), bvh.remarks.end());
  return clip;
}

}  // namespace mocaplm
