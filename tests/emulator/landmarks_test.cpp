#include "emulator/landmarks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "common/angles.h"
#include "common/random.h"
#include "emulator/body.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth.h"
#include "motion/turn.h"

namespace mocaplm::landmarks_test {

namespace {

Clip dance(std::size_t index = 0) {
  SynthConfig config;
  config.seconds = 2;
  config.fps = 30;
  return make_dance(plan_dances(config).at(index), config);
}

TEST(Landmarks, TreeOfAllAndOfSome) {
  const LandmarkTree all = smpl_landmarks();
  EXPECT_EQ(all.limbs(), 23);
  EXPECT_EQ(all.parents, std::vector<int>(joint_parents().begin(), joint_parents().end()));
  const LandmarkTree some = smpl_landmarks({20, 16, 7});
  EXPECT_EQ(some.names,
            (std::vector<std::string>{"pelvis", "left_ankle", "left_shoulder", "left_wrist"}));
  EXPECT_EQ(some.parents, (std::vector<int>{-1, 0, 0, 2}));
  EXPECT_THROW(smpl_landmarks({0}), UsageError);
}

TEST(Landmarks, DirectionsAreThoseOfThePositions) {
  const Clip clip = dance();
  const LandmarkTree tree = smpl_landmarks(thesis_joints());
  const PostureSequence sequence = clip_postures(clip, tree, "keep");
  for (Eigen::Index t = 0; t < clip.frames(); t += 7) {
    const JointPositions joints = joint_positions(clip, t);
    for (std::size_t i = 1; i < tree.names.size(); ++i) {
      const int a = joint_index(tree.names[i]);
      const int b = joint_index(tree.names[static_cast<std::size_t>(tree.parents[i])]);
      const Eigen::Vector3d limb = (joints.row(a) - joints.row(b)).transpose();
      EXPECT_LT((sequence.at(t).col(static_cast<Eigen::Index>(i) - 1) * limb.norm() - limb).norm(),
                1e-12);
    }
  }
}

TEST(Landmarks, PlaceAndHeadingAreTakenAway) {
  Clip clip = dance(3);
  const LandmarkTree tree = smpl_landmarks();
  Clip other = turned(clip, 1.1);
  other.trans.rowwise() += Eigen::RowVector3d(3, 0.2, -1);
  const auto difference = [&](const std::string& heading) {
    return (clip_postures(clip, tree, heading).values - clip_postures(other, tree, heading).values)
        .cwiseAbs()
        .maxCoeff();
  };
  EXPECT_GT(difference("keep"), 0.1);
  EXPECT_LT(difference("start"), 1e-12);
  EXPECT_LT(difference("mean"), 1e-12);
  EXPECT_LT(difference("every"), 1e-12);
  // "every" leaves no frame that faces elsewhere than +Z: the hips' and shoulders' sum is along x.
  EXPECT_THROW(clip_postures(clip, tree, "strat"), UsageError);
}

TEST(Landmarks, AnyTreeOfPositions) {
  const LandmarkTree tree{{"a", "b", "c"}, {-1, 0, 1}};
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> positions(6, 3);
  positions << 0, 0, 0, 2, 0, 0, 2, 3, 0, 1, 1, 1, 1, 1, 5, 1, 0, 5;
  const PostureSequence sequence = posture_sequence(tree, positions, in_file("x"));
  Eigen::MatrixXd expected(6, 2);
  expected << 1, 0, 0, 0, 0, 1, 0, 0, 1, -1, 0, 0;
  EXPECT_EQ(sequence.values, expected);
  positions.row(5) = positions.row(4);
  try {
    posture_sequence(tree, positions, in_file("x"));
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("x: frame 1: c and b lie at one point"),
              std::string::npos)
        << error.what();
  }
  positions(5, 0) = std::nan("");
  EXPECT_THROW(posture_sequence(tree, positions, in_file("x")), DataError);
  EXPECT_THROW(posture_sequence(tree, positions.topRows(4), in_file("x")), DataError);
  EXPECT_THROW(check_tree({{"a", "b"}, {-1, 1}}), UsageError);
  EXPECT_THROW(check_tree({{"a", "b"}, {0, 0}}), UsageError);
}

bool is_leaf(std::size_t joint) {
  for (const int parent : joint_parents())
    if (parent == static_cast<int>(joint)) return false;
  return true;
}

// With the clip's own turns, every rotation that moves a limb comes back.
TEST(Body, RotationsComeBack) {
  const Clip clip = dance(5);
  const LandmarkTree tree = smpl_landmarks();
  const PostureSequence sequence = clip_postures(clip, tree, "keep");
  const Clip again = postures_clip(sequence, tree, limb_turns(clip, tree), clip.fps, "again");
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const auto a = joint_world_rotations(clip, t), b = joint_world_rotations(again, t);
    for (std::size_t j = 0; j < kJoints; ++j)
      if (!is_leaf(j)) {
        ASSERT_LT((a[j] - b[j]).norm(), 1e-9) << "frame " << t << ", " << joint_names()[j];
      }
  }
}

// Without turns the limbs' directions still come back, but for those that bend at one joint.
TEST(Body, DirectionsComeBackWithoutTurns) {
  const Clip clip = dance(7);
  for (const auto& joints : {std::vector<int>{}, thesis_joints()}) {
    const LandmarkTree tree = smpl_landmarks(joints);
    const PostureSequence sequence = clip_postures(clip, tree, "start");
    const Clip again = postures_clip(sequence, tree, {}, clip.fps, "again");
    const PostureSequence back = clip_postures(again, tree, "keep");
    for (std::size_t i = 1; i < tree.names.size(); ++i) {
      int siblings = 0;
      for (const int parent : tree.parents) siblings += parent == tree.parents[i];
      // Where joints between landmarks bend, the body cannot follow both hips and shoulders.
      if (siblings > 1 && !joints.empty()) continue;
      for (Eigen::Index t = 0; t < clip.frames(); ++t)
        ASSERT_LT((back.at(t) - sequence.at(t)).col(static_cast<Eigen::Index>(i) - 1).norm(), 1e-9)
            << tree.names[i];
    }
  }
}

TEST(Body, TheLowerFootStaysInItsPlace) {
  const Clip clip = dance(2);
  const LandmarkTree tree = smpl_landmarks();
  const Clip again =
      postures_clip(clip_postures(clip, tree, "start"), tree, limb_turns(clip, tree), 30, "again");
  const int feet[4] = {7, 8, 10, 11};
  const double sole =
      rest_joints()(11, 1) < rest_joints()(10, 1) ? rest_joints()(11, 1) : rest_joints()(10, 1);
  JointPositions last;
  for (Eigen::Index t = 0; t < again.frames(); ++t) {
    const JointPositions joints = joint_positions(again, t);
    double lowest = 1e9;
    int support = 0;
    for (const int foot : feet)
      if (joints(foot, 1) - (rest_joints()(foot, 1) - sole) < lowest) {
        lowest = joints(foot, 1) - (rest_joints()(foot, 1) - sole);
        support = foot;
      }
    EXPECT_NEAR(lowest, 0, 1e-9);
    if (t > 0) {
      EXPECT_NEAR(joints(support, 0), last(support, 0), 1e-9);
      EXPECT_NEAR(joints(support, 2), last(support, 2), 1e-9);
    }
    last = joints;
  }
  EXPECT_NEAR(joint_positions(again, 0)(0, 0), 0, 1e-12);
}

TEST(Body, TurnsAreReadAndAveragedAlongTheShorterWay) {
  Eigen::MatrixXd turns(1, 3);
  turns << 3.0, -3.0, -2.0;
  const Eigen::MatrixXd at = turns_at(turns, Eigen::Vector3d(0.5, 1.25, 5));
  EXPECT_NEAR(at(0, 0), kPi, 1e-12);
  EXPECT_NEAR(at(0, 1), -2.75, 1e-12);
  EXPECT_NEAR(at(0, 2), -2, 1e-12);
  Eigen::MatrixXd other = turns;
  other(0, 0) = -3;
  const Eigen::MatrixXd mean = mean_turns({turns, other});
  EXPECT_NEAR(std::abs(mean(0, 0)), kPi, 1e-12);
  EXPECT_NEAR(mean(0, 2), -2, 1e-12);
}

}  // namespace

}  // namespace mocaplm::landmarks_test
