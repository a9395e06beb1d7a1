// Turning a file's world into ours. The axis that is up in the rest pose need not be the one that
// is up in the motion: programs with Z up write rest poses with Y up, and the other way round.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "motion/formats/rest_pose.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

struct WorldTurn {
  Eigen::Matrix3d turn;
  std::string remark;  // what was taken for granted; empty: nothing
};

// `poses` below: some of the file's (some_poses).

// What is to be added to all positions, in our world and the file's unit: the height of the root's
// OFFSET where a program has written the root's positions as relative to it (iClone), so that the
// figure walks so far under the floor; else zero.
Eigen::Vector3d root_offset_to_add(const Bvh& bvh, const std::vector<BvhPose>& poses,
                                   const SourceFigure& figure, const Eigen::Matrix3d& turn);

// Up is `option`'s axis, else the map's, else the rest pose's unless the figure stands along
// another axis in most frames, else +y. The heading follows the rest pose where both are up alike,
// else the map's `facing`, else as turn_to_y_up has it.
WorldTurn find_world_turn(const std::vector<BvhPose>& poses, const RetargetMap& map,
                          const SourceFigure& figure, const RestPose& rest, UpAxis option);

}  // namespace mocaplm
