#include "motion/formats/retarget.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/formats/figure_size.h"
#include "motion/formats/rest_pose.h"
#include "motion/formats/retarget_map.h"
#include "motion/formats/source_figure.h"
#include "motion/formats/trunk.h"
#include "motion/formats/world_turn.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

constexpr double kHalfTurn = kPi - 1e-6;  // with room for rounding

// A bone from a joint to its child, by SMPL index.
struct LimbBone {
  const char* name;
  std::size_t joint, child;

  Eigen::Vector3d at_rest() const {
    return rest_bone(static_cast<int>(joint), static_cast<int>(child));
  }
};
// Bones whose directions are kept exactly and reported.
constexpr LimbBone kLimbBones[] = {{"left_upper_arm", 16, 18},  {"left_lower_arm", 18, 20},
                                   {"right_upper_arm", 17, 19}, {"right_lower_arm", 19, 21},
                                   {"left_upper_leg", 1, 4},    {"left_lower_leg", 4, 7},
                                   {"right_upper_leg", 2, 5},   {"right_lower_leg", 5, 8}};
// SMPL's joints whose rotations turn an arm.
constexpr int kArms[] = {16, 17, 18, 19, 20, 21};

// The joints of the file that SMPL's joints come from, and all above them, ascending.
std::vector<std::size_t> with_ancestors(const Bvh& bvh, const SourceJoints& joints) {
  std::vector<bool> needed(bvh.joints.size(), false);
  for (int joint : joints)
    for (; joint >= 0; joint = bvh.joints[joint_index(joint)].parent)
      needed[joint_index(joint)] = true;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < needed.size(); ++i)
    if (needed[i]) indices.push_back(i);
  return indices;
}

// Where the legs of the zero pose are spread to the side, as the turn about +Z that undoes it. The
// original CMU skeleton stands with its legs 20 degrees apart, and its feet tilted with them.
Eigen::Matrix3d undo_spread(const Eigen::Vector3d& shin) {
  const double angle = std::atan2(shin.x(), -shin.y());
  if (std::abs(angle) < 0.175) return Eigen::Matrix3d::Identity();  // 10 degrees: straight
  return Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

class Retargeter {
 public:
  Retargeter(const Bvh& bvh, const RetargetMap& map, const BvhOptions& options,
             const std::string& file)
      : bvh_(bvh),
        map_(map),
        figure_(bvh, map, file),
        needed_(with_ancestors(bvh, figure_.joints())),
        rest_(find_rest_pose(bvh, map, figure_, file)) {
    figure_.find_limb_ends(rest_.pose);
    const std::vector<BvhPose> poses = some_poses(bvh, needed_);
    const WorldTurn world = find_world_turn(poses, map, figure_, rest_, options.up);
    turn_ = world.turn;
    turn_quaternion_ = quaternion_from_matrix(turn_);
    if (!world.remark.empty()) remarks_.push_back({"up axis", world.remark});
    lift_.setZero();
    if (!options.absolute_root) lift_ = root_offset_to_add(bvh, poses, figure_, turn_);
    if (lift_.y() > 0)
      remarks_.push_back({"root offset",
                          "the height of the root's OFFSET is added to its "
                          "positions, without which the feet are as far under the "
                          "floor"});
    pose_bvh(bvh_, Eigen::Index{0}, pose_);
    size_ = find_size(figure_.leg(pose_), figure_.height(pose_), map, options, file);
    remarks_.insert(remarks_.end(), size_.remarks.begin(), size_.remarks.end());
    if (!rest_.zero && rest_.source != "the known axes of its joints")
      remarks_.push_back({"rest pose", "rotations are counted from " + rest_.source +
                                           ", where the figure stands; in the zero pose it does "
                                           "not"});
    count_from_rest();
    hands_ = {hand_at_rest(20), hand_at_rest(21)};
    const bool own_turns = map.scheme_spine && figure_.has(6);
    trunk_.emplace(bvh_, poses, figure_, rest_, turn_, map.align && !own_turns);
  }

  double unit() const { return size_.unit; }
  double path_scale() const { return size_.path; }
  double height() const { return figure_.height(rest_.pose) * size_.unit; }
  const std::string& rest_pose() const { return rest_.source; }
  const std::vector<Remark>& remarks() const { return remarks_; }
  // True when the source turns this joint. A hand's joint only says where the wrist points.
  bool has(std::size_t joint) const {
    return figure_.has(static_cast<int>(joint)) && !(map_.align && joint >= 22);
  }
  // The direction of a bone of the source in the frame last converted, in our world; not of unit
  // length.
  Eigen::Vector3d bone(const LimbBone& b) const { return position(b.child) - position(b.joint); }

  // World rotations of SMPL's joints in one frame, and where its pelvis joint lies, metres.
  Eigen::Vector3d convert(Eigen::Index frame, Rotations& world) {
    pose_bvh(bvh_, frame, needed_, pose_);
    for (std::size_t j = 0; j < kJoints; ++j)
      if (has(j)) world[j] = turn_quaternion_ * quaternion_from_matrix(source(j)) * from_rest_[j];
    if (map_.align)
      trunk_->correct_ends(pose_, world);
    else if (!has(9))
      world[9] = world[0];
    trunk_->fill_spine(world);
    trunk_->keep_direction(pose_, world);
    if (!has(12)) world[12] = has(15) ? world[9].slerp(0.5, world[15]) : world[9];
    if (!has(15)) world[15] = world[12];
    for (const std::size_t j : {1, 2, 4, 5, 7, 8, 10, 11, 13, 14, 16, 17, 18, 19, 20, 21, 22, 23})
      if (!has(j)) world[j] = world[joint_index(joint_parents()[j])];
    if (map_.align) {
      for (const LimbBone& limb : kLimbBones) align(limb, bone(limb), world);
      for (std::size_t side = 0; side < 2; ++side) align_wrist(side, world);
    }
    for (const std::size_t j : {10, 11, 18, 19, 20, 21, 22, 23})
      if (!has(j)) world[j] = world[joint_index(joint_parents()[j])];
    const Eigen::Vector3d hips = 0.5 * size_.unit * size_.path * (position(1) + position(2));
    return hips - world[0] * (0.5 * (rest_joint(1) + rest_joint(2)) - rest_joint(0));
  }

 private:
  const Eigen::Matrix3d& source(std::size_t joint) const {
    return pose_.rotations[joint_index(figure_.source(static_cast<int>(joint)))];
  }
  Eigen::Vector3d position(std::size_t joint) const {
    return turn_ * figure_.at(pose_, static_cast<int>(joint)) + lift_;
  }

  // For each joint the rotation with which world rotation times it is the rotation relative to
  // SMPL's rest pose.
  void count_from_rest() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const int joint = figure_.source(static_cast<int>(j));
      if (joint < 0) continue;
      Eigen::Matrix3d from = (rest_.front * rest_.pose.rotations[joint_index(joint)]).transpose();
      const bool left_foot = j == 7 || j == 10, right_foot = j == 8 || j == 11;
      if (rest_.zero && map_.align && (left_foot || right_foot))
        from *= undo_spread(rest_.bone(figure_, left_foot ? 4 : 5, left_foot ? 7 : 8)).transpose();
      from_rest_[j] = quaternion_from_matrix(from);
    }
    if (rest_.stance == RestStance::t_pose || !map_.align) return;
    // Arms that hang in the rest pose are turned there, in SMPL's terms.
    for (const int j : kArms) {
      const int upper = j < 20 ? j : j - 2;
      const Eigen::Quaterniond hanging =
          shortest_rotation(rest_bone(upper, upper + 2), rest_.bone(figure_, upper, upper + 2));
      from_rest_[joint_index(j)] = from_rest_[joint_index(j)] * hanging;
    }
  }

  // Turns the bone's joint by the smallest rotation that brings SMPL's bone into the direction
  // `to`.
  static void align(const LimbBone& bone, const Eigen::Vector3d& to, Rotations& world) {
    if (to.norm() < 1e-9) return;
    const Eigen::Vector3d from = world[bone.joint] * bone.at_rest();
    world[bone.joint] = (shortest_rotation(from, to) * world[bone.joint]).normalized();
  }
  void align_wrist(std::size_t side, Rotations& world) const {
    const LimbBone hand = {"", 20 + side, 22 + side};
    if (!has(hand.joint)) return;
    align(hand,
          figure_.has(22 + static_cast<int>(side)) ? bone(hand) : world[hand.joint] * hands_[side],
          world);
  }
  // Where a hand without a joint of its own points, seen from the wrist's rotation: to its fingers,
  // else to its End Site, else on along the forearm.
  Eigen::Vector3d hand_at_rest(int wrist) const {
    const int joint = figure_.source(wrist);
    if (joint < 0) return Eigen::Vector3d::UnitX();
    const Eigen::Vector3d forearm = rest_.bone(figure_, wrist - 2, wrist);
    const Eigen::Matrix3d world = rest_.front * rest_.pose.rotations[joint_index(joint)];
    // Known axes are those of a T-pose: straight to the side.
    Eigen::Vector3d to =
        rest_.source == "the known axes of its joints"
            ? Eigen::Vector3d((wrist == 20 ? 1 : -1) * forearm.norm() * Eigen::Vector3d::UnitX())
            : forearm;
    double nearest = 0.5;  // the thumb points elsewhere
    const auto offer = [&](const Eigen::Vector3d& bone) {
      if (bone.norm() < 0.01 * forearm.norm()) return;
      const double along = bone.normalized().dot(forearm.normalized());
      if (along > nearest) to = bone, nearest = along;
    };
    for (const BvhJoint& child : bvh_.joints)
      if (child.parent == joint) offer(world * child.offset);
    for (const Eigen::Vector3d& site : bvh_.joints[joint_index(joint)].end_sites)
      offer(world * site);
    return from_rest_[joint_index(wrist)].conjugate() * (world.transpose() * to);
  }

  const Bvh& bvh_;
  const RetargetMap& map_;
  SourceFigure figure_;
  std::vector<std::size_t> needed_;  // the file's joints that have a part in the result
  RestPose rest_;
  Eigen::Matrix3d turn_;
  Eigen::Quaterniond turn_quaternion_;
  Eigen::Vector3d lift_;
  Rotations from_rest_;
  FigureSize size_;
  std::optional<Trunk> trunk_;
  std::vector<Remark> remarks_;
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
  for (std::size_t i = 0; i < std::size(kLimbBones); ++i) {
    const LimbBone& limb = kLimbBones[i];
    const Eigen::Vector3d source = retargeter.bone(limb);
    if (source.norm() < 1e-9) continue;
    const Eigen::Vector3d ours = world[limb.joint] * limb.at_rest();
    const double error = angle_between(source, ours) * 180 / kPi;
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
  report.path_scale = retargeter.path_scale();
  report.rest_pose = retargeter.rest_pose();
  report.remarks = retargeter.remarks();
  for (const LimbBone& limb : kLimbBones) report.limbs.push_back({limb.name});
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
    clip.trans.row(t) = (pelvis - rest_joint(0)).transpose();
    set_poses(clip, t, world, retargeter);
    if (report) measure(clip, t, retargeter, *report);
  }
  if (report) finish(*report);
  check_clip(clip, file);
  return clip;
}

Clip retarget_bvh(const Bvh& bvh, const std::string& file, const BvhOptions& options,
                  RetargetReport* report) {
  const RetargetMap map = options.map_file.empty() ? detect_map(bvh, file, options.write_map)
                                                   : load_map(options.map_file);
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
