// The pose of a file's figure from which its rotations are counted, as SMPL counts them from a
// T-pose.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "motion/formats/retarget_map.h"
#include "motion/formats/source_figure.h"
#include "motion/formats/standing.h"

namespace mocaplm {

struct RestPose {
  BvhPose pose;
  Eigen::Matrix3d front;              // turns the pose's world so that the figure stands, facing +Z
  std::optional<Eigen::Vector3d> up;  // the file's axis that is up there; none: not of the file
  bool zero = false;                  // all rotations zero
  RestStance stance = RestStance::t_pose;
  std::string source;  // for people: "the zero pose", "frame 0", ...

  // From one of SMPL's joints to another, facing +Z, in the file's unit.
  Eigen::Vector3d bone(const SourceFigure& figure, int from, int to) const {
    return front * (figure.at(pose, to) - figure.at(pose, from));
  }
};

// What the map says, else the first of these in which the figure stands (standing.h): the zero
// pose; the map's known axes; frame 0; the zero pose with each bone turned, from the pelvis
// outwards, by the smallest rotation that brings it where SMPL's rest pose has it, and thighs and
// upper arms about themselves as knees and elbows bend. Throws DataError
// where the map's pose does not stand, or none does.
RestPose find_rest_pose(const Bvh& bvh, const RetargetMap& map, const SourceFigure& figure,
                        const std::string& file);

}  // namespace mocaplm
