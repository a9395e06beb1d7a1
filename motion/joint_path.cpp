#include "motion/joint_path.h"

#include <cmath>

#include "motion/skeleton.h"

namespace mocaplm {

Eigen::MatrixXd joint_path(const Clip& clip, int joint, bool in_body) {
  Eigen::MatrixXd path(clip.frames(), 3);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    path.row(t) = joints.row(joint);
    if (in_body) path.row(t) -= joints.row(0);
  }
  if (!in_body || clip.frames() == 0) return path;
  const Eigen::Vector3d forward = joint_world_rotations(clip, 0)[0].col(2);
  const double length = std::hypot(forward.x(), forward.z());
  if (length < 1e-6) return path;  // lies on the back or the face: no heading
  const double s = forward.x() / length, c = forward.z() / length;
  Eigen::Matrix3d turn;  // takes (s, 0, c) to (0, 0, 1)
  turn << c, 0, -s, 0, 1, 0, s, 0, c;
  return path * turn.transpose();
}

}  // namespace mocaplm
