// Writing a clip as BVH text.
#include <cmath>

#include "common/angles.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/bvh.h"
#include "motion/formats/skeletons.h"
#include "motion/rotation.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

// How lengths are written: 1e-8 m or 1e-9 m whatever the unit.
struct Lengths {
  double per_metre;
  int offset_digits, channel_digits;
};
constexpr Lengths kCentimetres = {100, 6, 7}, kMetres = {1, 8, 9};

void append_offset(std::string& text, const std::string& indent, const Eigen::Vector3d& offset,
                   const Lengths& lengths) {
  text += indent + "OFFSET";
  for (int axis = 0; axis < 3; ++axis)
    append_fixed(text += ' ', offset[axis] * lengths.per_metre, lengths.offset_digits);
  text += '\n';
}

std::vector<int> children_of(const OutSkeleton& skeleton, int joint) {
  std::vector<int> children;
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i)
    if (skeleton.joints[i].parent == joint) children.push_back(static_cast<int>(i));
  return children;
}

// A joint with six channels carries a position: the root, and the joint that travels.
bool has_place(const OutJoint& joint) {
  return joint.parent < 0 || joint.travels;
}

// Appends a joint and all below it to the text and their indices to `order`.
void append_joint(std::string& text, const OutSkeleton& skeleton, int index,
                  const std::string& indent, const Lengths& lengths, std::vector<int>& order) {
  order.push_back(index);
  const OutJoint& joint = skeleton.joints[static_cast<std::size_t>(index)];
  text += indent + (joint.parent < 0 ? "ROOT " : "JOINT ") + joint.name + "\n" + indent + "{\n";
  const std::string inside = indent + "  ";
  Eigen::Vector3d offset = joint.rest;
  if (joint.parent >= 0) offset -= skeleton.joints[static_cast<std::size_t>(joint.parent)].rest;
  // SMPL's own rest pose has its origin in the middle of the body; the others stand on the floor.
  else if (skeleton.scheme != OutScheme::smpl)
    offset.y() += skeleton.lift;
  append_offset(text, inside, offset, lengths);
  text += inside + (has_place(joint)
                        ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
                        : "CHANNELS 3 Zrotation Xrotation Yrotation\n");
  const std::vector<int> children = children_of(skeleton, index);
  for (const int child : children) append_joint(text, skeleton, child, inside, lengths, order);
  if (children.empty() && joint.end) {
    text += inside + "End Site\n" + inside + "{\n";
    append_offset(text, inside + "  ", *joint.end, lengths);
    text += inside + "}\n";
  }
  text += indent + "}\n";
}

// The Euler angles of the same rotation nearest to those of the frame before, so that curves drawn
// through them do not jump: (a, b, c) and (a + pi, pi - b, c + pi) are the same, as are whole
// turns.
Eigen::Vector3d continuous_euler(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& previous) {
  const Eigen::Vector3d angles = euler_from_matrix(matrix, kZxy);
  Eigen::Vector3d best = angles, other(angles[0] + kPi, kPi - angles[1], angles[2] + kPi);
  for (int i = 0; i < 3; ++i) {
    best[i] = nearest_turn(best[i], previous[i]);
    other[i] = nearest_turn(other[i], previous[i]);
  }
  return (other - previous).squaredNorm() < (best - previous).squaredNorm() - 1e-9 ? other : best;
}

void append_place(std::string& text, const Eigen::Vector3d& place, int digits) {
  for (int axis = 0; axis < 3; ++axis) {
    append_fixed(text, place[axis], digits);
    text += ' ';
  }
}

}  // namespace

std::string bvh_text(const Clip& clip, BvhUnit unit, OutScheme scheme) {
  const Lengths& lengths = unit == BvhUnit::metres ? kMetres : kCentimetres;
  const OutSkeleton skeleton = out_skeleton(clip, scheme);
  std::string text = "HIERARCHY\n";
  std::vector<int> order;
  append_joint(text, skeleton, 0, "", lengths, order);
  text += "MOTION\nFrames: " + std::to_string(clip.frames()) + "\nFrame Time: ";
  append_fixed(text, 1 / clip.fps, 15);
  text += '\n';
  std::vector<Eigen::Vector3d> previous(skeleton.joints.size(), Eigen::Vector3d::Zero());
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    for (const int index : order) {
      const auto i = static_cast<std::size_t>(index);
      const OutJoint& joint = skeleton.joints[i];
      if (joint.travels)
        append_place(text, out_place(clip, t) * lengths.per_metre, lengths.channel_digits);
      else if (has_place(joint))
        append_place(text, Eigen::Vector3d::Zero(), lengths.channel_digits);
      previous[i] =
          continuous_euler(out_rotation(skeleton, clip, t, i).toRotationMatrix(), previous[i]);
      for (int axis = 0; axis < 3; ++axis) {
        append_fixed(text, previous[i][axis] * 180 / kPi, 7);
        text += ' ';
      }
    }
    text.back() = '\n';
  }
  return text;
}

void write_bvh(const std::filesystem::path& path, const Clip& clip, BvhUnit unit,
               OutScheme scheme) {
  check_clip(clip, path.string());
  write_file(path, bvh_text(clip, unit, scheme));
}

}  // namespace mocaplm
