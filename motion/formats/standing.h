// Whether a figure stands in a pose from which its rotations can be told: upright, legs down and
// straight, arms straight and spread (T), half spread (A) or hanging (N).
#pragma once

#include <Eigen/Core>
#include <string>

#include "motion/formats/source_figure.h"

namespace mocaplm {

enum class RestStance { none, t_pose, a_pose, hanging };

struct Standing {
  RestStance stance = RestStance::none;
  std::string why_not;                              // of `none`: a sentence
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();    // a signed axis of the pose's world
  Eigen::Vector3d left = Eigen::Vector3d::UnitX();  // level, unit length
};

// `strict` for a frame of a motion, in which people stand by chance: less may be bent, tilted or
// unequal. Up is the signed axis nearest to the trunk.
Standing standing_in(const SourceFigure& figure, const BvhPose& pose, bool strict);

// The rotation that brings `up` and `left` (at right angles) to +Y and +X: the figure faces +Z.
Eigen::Matrix3d to_front(const Eigen::Vector3d& up, const Eigen::Vector3d& left);

Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v);

}  // namespace mocaplm
