// Writing a clip as BVH text.
#include <cmath>

#include "common/files.h"
#include "common/text.h"
#include "motion/formats/bvh.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr EulerOrder kOrder = {2, 0, 1};  // ZXY

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

void append_joint(std::string& text, int joint, const std::string& indent, const Lengths& lengths) {
  const auto j = static_cast<std::size_t>(joint);
  const int parent = joint_parents()[j];
  const RestJoints& rest = rest_joints();
  text += indent + (parent < 0 ? "ROOT " : "JOINT ") + joint_names()[j] + "\n" + indent + "{\n";
  const std::string inside = indent + "  ";
  const Eigen::RowVector3d origin =
      parent < 0 ? Eigen::RowVector3d(0, 0, 0) : Eigen::RowVector3d(rest.row(parent));
  append_offset(text, inside, (rest.row(joint) - origin).transpose(), lengths);
  text += inside + (parent < 0
                        ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
                        : "CHANNELS 3 Zrotation Xrotation Yrotation\n");
  bool leaf = true;
  for (int child = joint + 1; child < kJoints; ++child)
    if (joint_parents()[static_cast<std::size_t>(child)] == joint) {
      append_joint(text, child, inside, lengths);
      leaf = false;
    }
  if (leaf) {  // a short bone in the parent's direction, so that viewers draw the last joint
    const Eigen::Vector3d bone = (rest.row(joint) - rest.row(parent)).transpose();
    text += inside + "End Site\n" + inside + "{\n";
    append_offset(text, inside + "  ", bone, lengths);
    text += inside + "}\n";
  }
  text += indent + "}\n";
}

double nearest_turn(double angle, double previous) {
  return angle + 2 * kPi * std::round((previous - angle) / (2 * kPi));
}

// The Euler angles of the same rotation nearest to those of the frame before, so that curves drawn
// through them do not jump: (a, b, c) and (a + pi, pi - b, c + pi) are the same, as are whole
// turns.
Eigen::Vector3d continuous_euler(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& previous) {
  const Eigen::Vector3d angles = euler_from_matrix(matrix, kOrder);
  Eigen::Vector3d best = angles, other(angles[0] + kPi, kPi - angles[1], angles[2] + kPi);
  for (int i = 0; i < 3; ++i) {
    best[i] = nearest_turn(best[i], previous[i]);
    other[i] = nearest_turn(other[i], previous[i]);
  }
  return (other - previous).squaredNorm() < (best - previous).squaredNorm() - 1e-9 ? other : best;
}

// Joints in the order in which the hierarchy is written: depth first.
void order_joints(int joint, std::vector<int>& order) {
  order.push_back(joint);
  for (int child = joint + 1; child < kJoints; ++child)
    if (joint_parents()[static_cast<std::size_t>(child)] == joint) order_joints(child, order);
}

}  // namespace

std::string bvh_text(const Clip& clip, BvhUnit unit) {
  const Lengths& lengths = unit == BvhUnit::metres ? kMetres : kCentimetres;
  std::string text = "HIERARCHY\n";
  append_joint(text, 0, "", lengths);
  text += "MOTION\nFrames: " + std::to_string(clip.frames()) + "\nFrame Time: ";
  append_fixed(text, 1 / clip.fps, 15);
  text += '\n';
  std::vector<int> order;
  order_joints(0, order);
  Eigen::Matrix<double, 3, kJoints> previous = Eigen::Matrix<double, 3, kJoints>::Zero();
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const Eigen::Vector3d pelvis =
        (clip.trans.row(t) + rest_joints().row(0)).transpose() * lengths.per_metre;
    append_fixed(text, pelvis.x(), lengths.channel_digits);
    append_fixed(text += ' ', pelvis.y(), lengths.channel_digits);
    append_fixed(text += ' ', pelvis.z(), lengths.channel_digits);
    for (const int joint : order) {
      const Eigen::Vector3d v = clip.poses.row(t).segment<3>(3 * joint).transpose();
      previous.col(joint) = continuous_euler(matrix_from_axis_angle(v), previous.col(joint));
      for (int i = 0; i < 3; ++i) append_fixed(text += ' ', previous(i, joint) * 180 / kPi, 7);
    }
    text += '\n';
  }
  return text;
}

void write_bvh(const std::filesystem::path& path, const Clip& clip, BvhUnit unit) {
  check_clip(clip, path.string());
  write_file(path, bvh_text(clip, unit));
}

}  // namespace mocaplm
