#include "motion/formats/joint_csv.h"

#include <gtest/gtest.h>

#include "common/csv.h"
#include "motion/formats/helpers.h"
#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace mocaplm::joint_csv_test {
namespace {

TEST(JointCsv, HoldsTheJointsOfEveryFrame) {
  Random random(1);
  const Clip clip = random_clip(random, 5, 29.97);
  const Csv table = parse_csv(joint_csv(clip), "joints.csv");
  ASSERT_EQ(table.columns.size(), 2u + 3 * kJoints);
  ASSERT_EQ(table.rows.size(), 5u);
  EXPECT_EQ(joint_csv(clip).rfind("frame,time,pelvis_x,pelvis_y,pelvis_z,left_hip_x,", 0), 0u);
  for (std::size_t t = 0; t < 5; ++t) {
    EXPECT_EQ(table.rows[t][table.column("frame")], std::to_string(t));
    EXPECT_NEAR(std::stod(table.rows[t][table.column("time")]), static_cast<double>(t) / 29.97,
                1e-6);
    const JointPositions joints = joint_positions(clip, static_cast<Eigen::Index>(t));
    for (int j = 0; j < kJoints; ++j)
      for (int axis = 0; axis < 3; ++axis) {
        const std::string column = joint_names()[static_cast<std::size_t>(j)] + "_" + "xyz"[axis];
        EXPECT_NEAR(std::stod(table.rows[t][table.column(column)]), joints(j, axis), 5.1e-7);
      }
  }
}

TEST(JointCsv, RefusesAnUnsoundClip) {
  Random random(2);
  const Scratch scratch;
  Clip clip = random_clip(random, 2, 30);
  clip.trans(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(write_joint_csv(scratch / "x.csv", clip), DataError);
  EXPECT_FALSE(std::filesystem::exists(scratch / "x.csv"));
}

}  // namespace
}  // namespace mocaplm::joint_csv_test
