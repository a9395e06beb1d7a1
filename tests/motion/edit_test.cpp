#include "motion/edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "motion/body_mesh.h"
#include "motion/floor.h"
#include "motion/helpers.h"
#include "motion/mirror.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::edit_test {
namespace {

Clip some_clip(std::uint64_t seed, Eigen::Index frames = 30) {
  Random random(seed);
  return random_clip(random, frames, 30);
}

EditConfig with(bool EditConfig::*option) {
  EditConfig config;
  config.*option = true;
  return config;
}

TEST(Edit, ChangesNothingUnasked) {
  const Clip clip = some_clip(1), same = edited(clip, {});
  EXPECT_EQ(same.poses, clip.poses);
  EXPECT_EQ(same.trans, clip.trans);
  EXPECT_EQ(same.fps, clip.fps);
}

TEST(Edit, ResamplesAndMirrorsAsTheirFunctionsDo) {
  const Clip clip = some_clip(2);
  EditConfig config = with(&EditConfig::mirror);
  config.fps = 12;
  const Clip got = edited(clip, config), wanted = mirror(resample(clip, 12));
  EXPECT_EQ(got.fps, 12);
  EXPECT_EQ(got.poses, wanted.poses);
  EXPECT_EQ(got.trans, wanted.trans);
  config.fps = 20000;
  EXPECT_THROW(edited(clip, config), UsageError);
}

TEST(Edit, FacesZWhereItBeganAndTurnsEverythingAlike) {
  for (std::uint64_t seed = 3; seed < 13; ++seed) {
    const Clip clip = some_clip(seed), got = edited(clip, with(&EditConfig::face));
    EXPECT_NEAR(facing(got, 0), 0, 1e-9);
    EXPECT_LT((got.trans.row(0) - clip.trans.row(0)).norm(), 1e-12);
    // One turn about the vertical through the first frame's pelvis takes every joint of every frame
    // to its new place.
    const double angle = -facing(clip, 0), s = std::sin(angle), c = std::cos(angle);
    const Eigen::RowVector3d centre = joint_positions(clip, 0).row(0);
    for (const Eigen::Index t : {0, 7, 29}) {
      const JointPositions before = joint_positions(clip, t), after = joint_positions(got, t);
      for (int j = 0; j < kJoints; ++j) {
        const Eigen::RowVector3d p = before.row(j) - centre;
        const Eigen::RowVector3d q(c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x());
        EXPECT_LT((q + centre - after.row(j)).norm(), 1e-9) << seed << " " << t << " " << j;
      }
    }
  }
}

TEST(Edit, FacingIsPositiveTowardsX) {
  Clip clip = some_clip(13, 1);
  clip.poses.row(0).head<3>() << 0, 0.7, 0;
  EXPECT_NEAR(facing(clip, 0), 0.7, 1e-12);
  clip.poses.row(0).head<3>() << kPi / 2, 0, 0;  // lies on the face
  EXPECT_EQ(facing(clip, 0), 0);
  clip.poses.row(0).head<3>() << 0.3, 0, 0;
  EXPECT_NEAR(facing(clip, 0), 0, 1e-12);
}

// The lowest point of the mesh is on the floor: of one who stands, on the heels, on the toes.
TEST(Edit, PutsTheSolesOnTheFloor) {
  for (const double pitch : {-0.5, -0.2, 0.0, 0.2, 0.5}) {
    Clip clip = some_clip(14, 40);
    clip.poses.setZero();
    clip.trans.col(1).setConstant(0.7);
    for (const int ankle : {7, 8}) clip.poses.col(3 * ankle).setConstant(pitch);
    const Clip got = edited(clip, with(&EditConfig::floor));
    MeshPoints positions, normals;
    pose_body(got, 20, positions, normals);
    EXPECT_NEAR(positions.col(1).minCoeff(), 0, 0.005) << pitch;
    EXPECT_EQ(got.trans.col(0), clip.trans.col(0));
    EXPECT_EQ(got.trans.col(2), clip.trans.col(2));
    EXPECT_EQ(got.poses, clip.poses);
  }
}

// Three frames in a hundred that lie far below do not lift the others; three lower steps are steps.
TEST(Edit, FloorIsNotThatOfFaults) {
  Clip clip = some_clip(14, 100);
  clip.poses.setZero();
  clip.trans.col(1).setConstant(0.7);
  for (const double below : {0.02, 0.4}) {
    clip.trans.col(1).segment(10, 3).setConstant(0.7 - below);
    const Clip got = edited(clip, with(&EditConfig::floor));
    const Clip alone = slice(got, below > 0.03 ? 50 : 10, 1);
    EXPECT_NEAR(ground_height(alone), 0, 1e-12) << below;
  }
}

// The height that one frame in fifty goes below, counted by sorting.
TEST(Edit, AlignFloorPutsTheJointsOnTheFloor) {
  const Clip clip = some_clip(14, 100);
  Clip got = clip;
  align_floor(got);
  std::vector<double> lowest;
  for (Eigen::Index t = 0; t < got.frames(); ++t) {
    const JointPositions joints = joint_positions(got, t);
    double low = 1e9;
    for (const int foot : {7, 8, 10, 11}) low = std::min(low, joints(foot, 1));
    lowest.push_back(low);
  }
  std::sort(lowest.begin(), lowest.end());
  EXPECT_NEAR(lowest[2], 0, 1e-12);
  EXPECT_EQ(got.trans.col(0), clip.trans.col(0));
  EXPECT_EQ(got.trans.col(2), clip.trans.col(2));
  EXPECT_EQ(got.poses, clip.poses);
}

}  // namespace
}  // namespace mocaplm::edit_test
