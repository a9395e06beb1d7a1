#include "motion/formats/skeletons.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/body_mesh.h"
#include "motion/floor.h"
#include "motion/formats/skeleton_names.h"
#include "motion/rotation.h"
#include "motion/smpl_joints.h"

namespace mocaplm {

namespace {

// SMPL's joints of one side.
struct SideJoints {
  int hip, knee, ankle, foot, collar, shoulder, elbow, wrist, hand;
  double left;  // +1, right: -1
};
constexpr SideJoints kSides[] = {{1, 4, 7, 10, 13, 16, 18, 20, 22, 1},
                                 {2, 5, 8, 11, 14, 17, 19, 21, 23, -1}};

Eigen::Vector3d row(const RestJoints& joints, int joint) {
  return joints.row(joint).transpose();
}

// How each of SMPL's joints is turned in the rest pose of the scheme: the bones of arms and legs by
// the smallest rotation, so that a reader who turns bones back the same way gets the same
// rotations.
std::array<Eigen::Quaterniond, kJoints> rest_turns(const RestJoints& body, double arms_down,
                                                   RestFeet feet) {
  std::array<Eigen::Quaterniond, kJoints> turns;
  turns.fill(Eigen::Quaterniond::Identity());
  const auto lay = [&](int joint, int child, const Eigen::Vector3d& direction) {
    turns[static_cast<std::size_t>(joint)] =
        shortest_rotation(row(body, child) - row(body, joint), direction);
  };
  for (const SideJoints& s : kSides) {
    const Eigen::Vector3d arm(s.left * std::cos(arms_down), -std::sin(arms_down), 0);
    lay(s.shoulder, s.elbow, arm);
    lay(s.elbow, s.wrist, arm);
    lay(s.wrist, s.hand, arm);
    turns[static_cast<std::size_t>(s.hand)] = turns[static_cast<std::size_t>(s.wrist)];
    lay(s.hip, s.knee, -Eigen::Vector3d::UnitY());
    lay(s.knee, s.ankle, -Eigen::Vector3d::UnitY());
    if (feet == RestFeet::natural) continue;
    Eigen::Vector3d sole = row(body, s.foot) - row(body, s.ankle);
    sole.y() = 0;
    turns[static_cast<std::size_t>(s.ankle)] = turns[static_cast<std::size_t>(s.foot)] =
        shortest_rotation(sole, Eigen::Vector3d::UnitZ());
  }
  return turns;
}

// Puts the joints of a scheme together, each after its parent.
class Builder {
 public:
  Builder(const Clip& clip, OutScheme scheme, RestFeet feet)
      : body_(rest_joints(clip)), names_(skeleton_names(scheme)) {
    skeleton_.scheme = scheme;
    skeleton_.of_smpl.fill(-1);
    turns_.fill(Eigen::Quaterniond::Identity());
    if (scheme != OutScheme::smpl)
      turns_ = rest_turns(body_, names_.arms_down_degrees * kPi / 180, feet);
    place();
    skeleton_.lift = kSoleBelowFoot - std::min(rest_(10, 1), rest_(11, 1));
  }

  OutSkeleton smpl() {
    for (int j = 0; j < kJoints; ++j) {
      const int parent = joint_parents()[static_cast<std::size_t>(j)];
      add(joint_names()[static_cast<std::size_t>(j)], parent, j);
      // A short bone in the parent's direction, so that viewers draw the last joint.
      if (parent >= 0) skeleton_.joints.back().end = row(rest_, j) - row(rest_, parent);
    }
    return std::move(skeleton_);
  }

  OutSkeleton scheme() {
    int root = -1;
    if (!names_.root.empty())
      root = addition(names_.root, -1, Eigen::Vector3d(0, -skeleton_.lift, 0));
    const int pelvis = add(names_.pelvis, root, kPelvis);
    if (names_.legs_first) legs(pelvis);
    trunk(pelvis);
    if (!names_.legs_first) legs(pelvis);
    finish_map();
    return std::move(skeleton_);
  }

 private:
  // SMPL's joints in the scheme's rest pose.
  void place() {
    rest_ = body_;
    for (int j = 1; j < kJoints; ++j) {
      const int parent = joint_parents()[static_cast<std::size_t>(j)];
      const Eigen::Quaterniond& turn = turns_[static_cast<std::size_t>(parent)];
      const Eigen::Vector3d bone = row(body_, j) - row(body_, parent);
      // Where nothing is turned the numbers stay the very same.
      if (turn.w() != 1 || rest_.row(parent) != body_.row(parent))
        rest_.row(j) = rest_.row(parent) + (turn * bone).transpose();
    }
  }

  // A joint of SMPL's.
  int add(const std::string& name, int parent, int smpl) {
    OutJoint joint;
    joint.name = names_.prefix + name;
    joint.parent = parent;
    joint.smpl = smpl;
    joint.travels = smpl == kPelvis;
    joint.rest = row(rest_, smpl);
    joint.turn = turns_[static_cast<std::size_t>(smpl)];
    const int above = parent < 0 ? -1 : sources_[static_cast<std::size_t>(parent)];
    for (int j = smpl; j != above; j = joint_parents()[static_cast<std::size_t>(j)])
      joint.path.insert(joint.path.begin(), j);
    skeleton_.of_smpl[static_cast<std::size_t>(smpl)] = static_cast<int>(skeleton_.joints.size());
    sources_.push_back(smpl);
    skeleton_.joints.push_back(joint);
    return static_cast<int>(skeleton_.joints.size()) - 1;
  }

  // A joint that only the scheme has, rigid with its parent; `rest` in the rest pose.
  int addition(const std::string& name, int parent, const Eigen::Vector3d& rest) {
    OutJoint joint;
    joint.name = names_.prefix + name;
    joint.parent = parent;
    joint.turns = false;
    joint.rest = rest;
    joint.turn = parent < 0 ? Eigen::Quaterniond::Identity()
                            : skeleton_.joints[static_cast<std::size_t>(parent)].turn;
    sources_.push_back(parent < 0 ? -1 : sources_[static_cast<std::size_t>(parent)]);
    skeleton_.joints.push_back(joint);
    return static_cast<int>(skeleton_.joints.size()) - 1;
  }

  OutJoint& joint(int index) { return skeleton_.joints[static_cast<std::size_t>(index)]; }

  // The end of the bone of a last joint: a joint where the scheme has one, else only a place.
  void end(const std::string& name, int parent, const Eigen::Vector3d& from_joint) {
    if (name.empty())
      joint(parent).end = from_joint;
    else
      joint(addition(name, parent, joint(parent).rest + from_joint)).end = 0.1 * from_joint;
  }

  void trunk(int pelvis) {
    int chest = add(names_.spine[0], pelvis, kSpine1);
    chest = add(names_.spine[1], chest, kSpine2);
    chest = add(names_.spine[2], chest, kSpine3);
    const Eigen::Vector3d top = row(rest_, kSpine3), base = row(rest_, kNeck);
    if (!names_.spine[3].empty()) chest = addition(names_.spine[3], chest, 0.5 * (top + base));
    using NeckAt = SkeletonNames::NeckAt;
    if (names_.neck_at == NeckAt::first) neck(chest);
    arm(chest, 0);
    if (names_.neck_at == NeckAt::between_the_arms) neck(chest);
    arm(chest, 1);
    if (names_.neck_at == NeckAt::last) neck(chest);
  }

  void neck(int chest) {
    int neck = add(names_.neck, chest, kNeck);
    if (!names_.neck1.empty())
      neck = addition(names_.neck1, neck, 0.5 * (row(rest_, kNeck) + row(rest_, kHead)));
    const int head = add(names_.head, neck, kHead);
    const double height =
        static_cast<double>(body_mesh().positions.col(1).maxCoeff()) - rest_joints()(kHead, 1);
    end(names_.head_end, head, {0, height, 0});
  }

  void arm(int chest, int side) {
    const SideJoints& s = kSides[side];
    int last = add(name(names_.collar, side), chest, s.collar);
    last = add(name(names_.shoulder, side), last, s.shoulder);
    last = add(name(names_.elbow, side), last, s.elbow);
    last = add(name(names_.wrist, side), last, s.wrist);
    end(name(names_.hand, side), last, row(rest_, s.hand) - row(rest_, s.wrist));
  }

  void legs(int pelvis) {
    for (int side = 0; side < 2; ++side) {
      const SideJoints& s = kSides[side];
      int last = pelvis;
      const std::string& joint_above = side == 0 ? names_.left_hip_joint : names_.right_hip_joint;
      if (!joint_above.empty()) last = addition(joint_above, pelvis, row(rest_, kPelvis));
      last = add(name(names_.hip, side), last, s.hip);
      last = add(name(names_.knee, side), last, s.knee);
      last = add(name(names_.ankle, side), last, s.ankle);
      last = add(name(names_.foot, side), last, s.foot);
      const Eigen::RowVector3d toes = figure_soles()[static_cast<std::size_t>(4 + side)].middle;
      end(name(names_.toe_end, side), last, joint(last).turn * Eigen::Vector3d(toes.transpose()));
    }
  }

  std::string name(const std::string& pattern, int side) const {
    const std::size_t at = pattern.find('*');
    if (at == std::string::npos) return pattern;
    return pattern.substr(0, at) + (side == 0 ? names_.left : names_.right) +
           pattern.substr(at + 1);
  }

  // The figure's hands go with the wrists where the scheme has no joint for them.
  void finish_map() {
    for (std::size_t j = 1; j < kJoints; ++j)
      if (skeleton_.of_smpl[j] < 0)
        skeleton_.of_smpl[j] = skeleton_.of_smpl[static_cast<std::size_t>(joint_parents()[j])];
  }

  const RestJoints& body_;
  const SkeletonNames& names_;
  RestJoints rest_;
  std::array<Eigen::Quaterniond, kJoints> turns_;
  std::vector<int> sources_;  // of each joint: the SMPL joint that it turns with, -1: the world
  OutSkeleton skeleton_;
};

bool is_identity(const Eigen::Quaterniond& turn) {
  return turn.w() == 1;
}

}  // namespace

const std::vector<std::string>& out_scheme_names() {
  static const std::vector<std::string> names = {"smpl", "mixamo", "unity", "unreal",
                                                 "vrm",  "rokoko", "cmu"};
  return names;
}

OutScheme out_scheme_of(const std::string& name) {
  const auto& names = out_scheme_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw UsageError("unknown skeleton \"" + name + "\"" + known_names(name, names));
  return static_cast<OutScheme>(found - names.begin());
}

std::string to_string(OutScheme scheme) {
  return out_scheme_names()[static_cast<std::size_t>(scheme)];
}

OutSkeleton out_skeleton(const Clip& clip, OutScheme scheme, RestFeet feet) {
  Builder builder(clip, scheme, feet);
  return scheme == OutScheme::smpl ? builder.smpl() : builder.scheme();
}

Eigen::Quaterniond out_rotation(const OutSkeleton& skeleton, const Clip& clip, Eigen::Index frame,
                                std::size_t joint) {
  const OutJoint& out = skeleton.joints[joint];
  if (!out.turns) return Eigen::Quaterniond::Identity();
  const auto local = [&](int smpl) {
    return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * smpl).transpose());
  };
  Eigen::Quaterniond rotation = local(out.path.front());
  for (std::size_t i = 1; i < out.path.size(); ++i) rotation = rotation * local(out.path[i]);
  // World rotations are R turn^-1: that of the joint against that of its parent.
  if (out.parent >= 0) {
    const Eigen::Quaterniond& above = skeleton.joints[static_cast<std::size_t>(out.parent)].turn;
    if (!is_identity(above)) rotation = above * rotation;
  }
  return is_identity(out.turn) ? rotation : rotation * out.turn.conjugate();
}

Eigen::Vector3d out_place(const Clip& clip, Eigen::Index frame) {
  return (clip.trans.row(frame) + rest_joints(clip).row(0)).transpose();
}

Clip out_rest_pose(const OutSkeleton& skeleton, const Clip& clip) {
  Clip rest;
  rest.fps = clip.fps;
  rest.body = clip.body;
  rest.poses.setZero(1, 72);
  rest.trans.setZero(1, 3);
  const auto turn = [&](int smpl) {
    return skeleton
        .joints[static_cast<std::size_t>(skeleton.of_smpl[static_cast<std::size_t>(smpl)])]
        .turn;
  };
  for (int j = 1; j < kJoints; ++j)
    rest.poses.row(0).segment<3>(3 * j) =
        axis_angle_from_quaternion(turn(joint_parents()[static_cast<std::size_t>(j)]).conjugate() *
                                   turn(j))
            .transpose();
  return rest;
}

}  // namespace mocaplm
