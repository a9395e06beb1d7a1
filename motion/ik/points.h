// Places on a body that files of positions give: SMPL's joints and a few points of head and feet
// that say how these are turned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "motion/skeleton.h"

namespace mocaplm {

// Beyond SMPL's 24 joints, whose numbers they continue.
enum ExtraPoint : int {
  kHeadTop = kJoints,
  kNose,
  kLeftEar,
  kRightEar,
  kLeftHeel,
  kRightHeel,
  kPoints
};

// "pelvis", ..., "right_hand", "top of the head", "nose", ...
const std::string& point_name(int point);

// Hips, knees, ankles, shoulders, elbows, wrists: without all of these nobody can be posed.
const std::array<int, 12>& needed_points();

// Positions over time. Metres and axes are whatever they are at each stage; nan where nothing is
// known.
struct PointTracks {
  double fps = 0;
  std::array<bool, kPoints> given{};
  Eigen::Matrix<double, Eigen::Dynamic, 3 * kPoints, Eigen::RowMajor> places;  // a row a frame

  Eigen::Index frames() const { return places.rows(); }
  bool has(int point) const { return given[static_cast<std::size_t>(point)]; }
  Eigen::Vector3d at(Eigen::Index frame, int point) const {
    return places.row(frame).segment<3>(3 * point).transpose();
  }
  Eigen::Vector3d middle(Eigen::Index frame, int a, int b) const {
    return (at(frame, a) + at(frame, b)) / 2;
  }
};

}  // namespace mocaplm
