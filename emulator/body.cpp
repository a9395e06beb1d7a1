#include "emulator/body.h"

#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "common/angles.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

struct Limb {
  Eigen::Index row;      // in the landmarks, of its lower end
  Eigen::Vector3d rest;  // its direction in the rest pose
};

struct Body {
  std::vector<int> joints;               // of each landmark
  std::vector<std::vector<Limb>> limbs;  // that begin at each landmark
};

Body body_of(const LandmarkTree& tree) {
  Body body;
  body.limbs.resize(tree.names.size());
  for (std::size_t i = 0; i < tree.names.size(); ++i) {
    body.joints.push_back(joint_index(tree.names[i]));
    if (i == 0) continue;
    const auto parent = static_cast<std::size_t>(tree.parents[i]);
    const Eigen::Vector3d rest =
        (rest_joints().row(body.joints[i]) - rest_joints().row(body.joints[parent])).transpose();
    body.limbs[parent].push_back({static_cast<Eigen::Index>(i), rest.normalized()});
  }
  return body;
}

// The rotation that brings the limbs' rest directions nearest to those of the posture (Kabsch
// 1976).
Eigen::Matrix3d nearest_rotation(const std::vector<Limb>& limbs, const Posture& posture) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Limb& limb : limbs) sum += posture.col(limb.row - 1) * limb.rest.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Eigen::Vector3d(1, 1, side < 0 ? -1 : 1).asDiagonal() *
         svd.matrixV().transpose();
}

// `parent` swung by the shortest way so that `rest` comes to lie along `direction`.
Eigen::Matrix3d swung(const Eigen::Matrix3d& parent, const Eigen::Vector3d& rest,
                      const Eigen::Vector3d& direction) {
  return shortest_rotation(parent * rest, direction).toRotationMatrix() * parent;
}

// World rotations of all 24 joints of one posture.
std::array<Eigen::Matrix3d, kJoints> world_rotations(const Body& body, const Posture& posture,
                                                     const Eigen::VectorXd& turns) {
  std::array<int, kJoints> landmark;
  landmark.fill(-1);
  for (std::size_t i = 0; i < body.joints.size(); ++i)
    landmark[static_cast<std::size_t>(body.joints[i])] = static_cast<int>(i);
  std::array<Eigen::Matrix3d, kJoints> world;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const int above = joint_parents()[j];
    world[j] = above < 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                         : world[static_cast<std::size_t>(above)];
    if (landmark[j] < 0) continue;
    const std::vector<Limb>& limbs = body.limbs[static_cast<std::size_t>(landmark[j])];
    if (limbs.size() > 1) world[j] = nearest_rotation(limbs, posture);
    if (limbs.size() != 1) continue;
    const Eigen::Vector3d direction = posture.col(limbs[0].row - 1);
    world[j] = Eigen::AngleAxisd(turns[landmark[j]], direction).toRotationMatrix() *
               swung(world[j], limbs[0].rest, direction);
  }
  return world;
}

// Feet: the ankles and the toes' joints, with their heights in the rest pose over the lowest.
struct Soles {
  std::array<Eigen::Index, 4> joints;
  Eigen::Vector4d rest;
};

const Soles& soles() {
  static const Soles of = [] {
    Soles found;
    const char* names[4] = {"left_ankle", "right_ankle", "left_foot", "right_foot"};
    for (std::size_t k = 0; k < 4; ++k) {
      found.joints[k] = joint_index(names[k]);
      found.rest[static_cast<Eigen::Index>(k)] = rest_joints()(found.joints[k], 1);
    }
    found.rest.array() -= found.rest.minCoeff();
    return found;
  }();
  return of;
}

// The root's way such that the lowest of the soles neither sinks, floats nor slides.
void stand(Clip& clip) {
  clip.trans.setZero();
  JointPositions last;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    double lowest = 1e9;
    Eigen::Index support = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Index joint = soles().joints[k];
      const double height = joints(joint, 1) - soles().rest[static_cast<Eigen::Index>(k)];
      if (height < lowest) {
        lowest = height;
        support = joint;
      }
    }
    // `joints` and `last` are those of a root at the origin.
    Eigen::RowVector3d at =
        t == 0
            ? Eigen::RowVector3d(-joints.row(0))
            : Eigen::RowVector3d(clip.trans.row(t - 1) + last.row(support) - joints.row(support));
    at.y() = -lowest;
    clip.trans.row(t) = at;
    last = joints;
  }
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * kPi);
}

}  // namespace

Eigen::MatrixXd limb_turns(const Clip& clip, const LandmarkTree& tree) {
  const Body body = body_of(tree);
  Eigen::MatrixXd turns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(body.joints.size()), clip.frames());
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto world = joint_world_rotations(clip, t);
    const JointPositions joints = joint_positions(clip, t);
    for (std::size_t i = 0; i < body.joints.size(); ++i) {
      if (body.limbs[i].size() != 1) continue;
      const Limb& limb = body.limbs[i][0];
      const int joint = body.joints[i];
      const int lower = body.joints[static_cast<std::size_t>(limb.row)];
      const Eigen::Matrix3d above =
          i == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                 : world[static_cast<std::size_t>(
                       body.joints[static_cast<std::size_t>(tree.parents[i])])];
      const Eigen::Vector3d direction =
          (joints.row(lower) - joints.row(joint)).transpose().normalized();
      // Joints between two landmarks may bend the limb.
      const Eigen::Matrix3d own =
          swung(world[static_cast<std::size_t>(joint)], limb.rest, direction);
      const Eigen::Matrix3d turn = own * swung(above, limb.rest, direction).transpose();
      turns(static_cast<Eigen::Index>(i), t) = axis_angle_from_matrix(turn).dot(direction);
    }
  }
  return turns;
}

Eigen::MatrixXd turns_at(const Eigen::MatrixXd& turns, const Eigen::VectorXd& times) {
  Eigen::MatrixXd at(turns.rows(), times.size());
  for (Eigen::Index k = 0; k < times.size(); ++k) {
    const double time = std::min(std::max(times[k], 0.0), static_cast<double>(turns.cols() - 1));
    const auto t = static_cast<Eigen::Index>(time);
    const Eigen::Index next = std::min(t + 1, turns.cols() - 1);
    for (Eigen::Index i = 0; i < turns.rows(); ++i)
      at(i, k) =
          turns(i, t) + (time - static_cast<double>(t)) * wrapped(turns(i, next) - turns(i, t));
  }
  return at;
}

Eigen::MatrixXd mean_turns(const std::vector<Eigen::MatrixXd>& turns) {
  Eigen::ArrayXXd sine = Eigen::ArrayXXd::Zero(turns.at(0).rows(), turns[0].cols());
  Eigen::ArrayXXd cosine = sine;
  for (const Eigen::MatrixXd& each : turns) {
    sine += each.array().sin();
    cosine += each.array().cos();
  }
  return sine.binaryExpr(cosine, [](double s, double c) { return std::atan2(s, c); }).matrix();
}

Clip postures_clip(const PostureSequence& sequence, const LandmarkTree& tree,
                   const Eigen::MatrixXd& turns, double fps, const std::string& name) {
  check_sequence(sequence, in_file(name));
  const Body body = body_of(tree);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(body.joints.size()));
  Clip clip;
  clip.name = name;
  clip.fps = fps;
  clip.poses = Poses::Zero(sequence.frames(), 72);
  clip.trans = Translations::Zero(sequence.frames(), 3);
  for (Eigen::Index t = 0; t < sequence.frames(); ++t) {
    const auto world = world_rotations(body, sequence.at(t),
                                       turns.size() == 0 ? none : Eigen::VectorXd(turns.col(t)));
    for (std::size_t j = 0; j < kJoints; ++j) {
      const int above = joint_parents()[j];
      const Eigen::Matrix3d local =
          above < 0
              ? world[j]
              : Eigen::Matrix3d(world[static_cast<std::size_t>(above)].transpose() * world[j]);
      clip.poses.row(t).segment<3>(3 * static_cast<Eigen::Index>(j)) =
          axis_angle_from_matrix(local).transpose();
    }
  }
  stand(clip);
  keep_continuous(clip, kPi);
  return clip;
}

}  // namespace mocaplm
