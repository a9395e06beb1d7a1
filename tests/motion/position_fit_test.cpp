#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/error.h"
#include "motion/helpers.h"
#include "motion/ik/fit.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth.h"

namespace mocaplm::position_fit_test {
namespace {

// The first `joints` of SMPL's joints of a clip.
PointTracks tracks_of(const Clip& clip, int joints = kJoints) {
  PointTracks tracks;
  tracks.fps = clip.fps;
  tracks.places.setConstant(clip.frames(), 3 * kPoints, std::nan(""));
  for (int j = 0; j < joints; ++j) tracks.given[static_cast<std::size_t>(j)] = true;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions positions = joint_positions(clip, t);
    for (int j = 0; j < joints; ++j) tracks.places.row(t).segment<3>(3 * j) = positions.row(j);
  }
  return tracks;
}

PointTracks only(PointTracks tracks, const std::vector<int>& joints) {
  tracks.given.fill(false);
  for (const int j : joints) tracks.given[static_cast<std::size_t>(j)] = true;
  for (int j = 0; j < kPoints; ++j)
    if (!tracks.given[static_cast<std::size_t>(j)])
      tracks.places.middleCols<3>(3 * j).setConstant(std::nan(""));
  return tracks;
}

double worst_distance(const PointTracks& tracks, const Clip& clip) {
  double worst = 0;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions positions = joint_positions(clip, t);
    for (int j = 0; j < kJoints; ++j)
      if (tracks.given[static_cast<std::size_t>(j)])
        worst = std::max(worst, (positions.row(j).transpose() - tracks.at(t, j)).norm());
  }
  return worst;
}

// The largest turn of a joint relative to its parent from one frame to the next, radians.
double largest_step(const Clip& clip) {
  double largest = 0;
  for (Eigen::Index t = 1; t < clip.frames(); ++t)
    for (int j = 0; j < kJoints; ++j) {
      const auto at = [&](Eigen::Index frame) {
        return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
      };
      largest = std::max(largest, geodesic_angle(at(t - 1), at(t)));
    }
  return largest;
}

// A body of other proportions that moves as `clip` does: every bone times a factor of its own, the
// same left and right.
PointTracks other_body(const Clip& clip, Random& random) {
  std::array<double, kJoints> factor;
  for (int j = 0; j < kJoints; ++j) {
    const int mirrored = mirrored_joints()[static_cast<std::size_t>(j)];
    factor[static_cast<std::size_t>(j)] =
        mirrored < j ? factor[static_cast<std::size_t>(mirrored)] : random.uniform(0.7, 1.4);
  }
  PointTracks tracks = tracks_of(clip);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions positions = joint_positions(clip, t);
    for (int j = 1; j < kJoints; ++j) {
      const int parent = joint_parents()[static_cast<std::size_t>(j)];
      tracks.places.row(t).segment<3>(3 * j) =
          tracks.places.row(t).segment<3>(3 * parent) +
          factor[static_cast<std::size_t>(j)] * (positions.row(j) - positions.row(parent));
    }
  }
  return tracks;
}

std::vector<Clip> dances() {
  SynthConfig config;
  config.dancers = config.choreographies = 1;
  config.seconds = 6;
  std::vector<Clip> clips;
  std::string last;
  for (const Dance& dance : plan_dances(config)) {
    if (dance.genre_code + std::to_string(static_cast<int>(dance.situation)) == last) continue;
    last = dance.genre_code + std::to_string(static_cast<int>(dance.situation));
    clips.push_back(make_dance(dance, config));
  }
  return clips;
}

TEST(PositionFit, FindsAnyPoseOfTheFigureItself) {
  Random random(11);
  const Clip clip = random_clip(random, 300, 60);
  for (const int joints : {22, 24}) {
    const PointTracks tracks = tracks_of(clip, joints);
    const PositionFit fit = fit_positions(tracks, 1, false);
    EXPECT_NEAR(fit.scale, 1, 1e-9);
    EXPECT_LT(worst_distance(tracks, fit.clip), 1e-6) << joints;
    EXPECT_LT(fit.from_bones.worst, 1e-4);
    EXPECT_LT(fit.from_source.worst, 1e-4);
    EXPECT_EQ(fit.clip.fps, 60);
  }
}

TEST(PositionFit, FindsEveryDanceWithoutAFlip) {
  for (const Clip& clip : dances()) {
    const PointTracks tracks = tracks_of(clip, 22);
    const PositionFit fit = fit_positions(tracks, 1, false);
    EXPECT_LT(worst_distance(tracks, fit.clip), 1e-6) << clip.name;
    EXPECT_LT(largest_step(fit.clip), std::max(0.25, 1.5 * largest_step(clip))) << clip.name;
  }
}

// The thesis's joints leave the spine and the shoulder blades free: limbs still lie where they
// were, by a few centimetres.
TEST(PositionFit, ThirteenJointsAreEnough) {
  for (const Clip& clip : dances()) {
    const PointTracks tracks = only(tracks_of(clip), thesis_joints());
    const PositionFit fit = fit_positions(tracks, 1, false);
    EXPECT_LT(fit.from_source.root_mean_square, 2) << clip.name;
    EXPECT_LT(worst_distance(tracks, fit.clip), 0.08) << clip.name;
    EXPECT_LT(largest_step(fit.clip), std::max(0.25, 1.5 * largest_step(clip))) << clip.name;
  }
}

TEST(PositionFit, KeepsLimbDirectionsOfOtherBodies) {
  Random random(12);
  const int bones[][2] = {{1, 4},   {2, 5},   {4, 7},   {5, 8},   {7, 10},  {8, 11},
                          {16, 18}, {17, 19}, {18, 20}, {19, 21}, {20, 22}, {21, 23}};
  for (const Clip& clip : dances()) {
    const PointTracks tracks = other_body(clip, random);
    const PositionFit fit = fit_positions(tracks, 1, false);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const JointPositions posed = joint_positions(fit.clip, t);
      const auto angle = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return std::atan2(a.cross(b).norm(), a.dot(b));
      };
      for (const auto& [a, b] : bones)
        ASSERT_LT(
            angle((posed.row(b) - posed.row(a)).transpose(), tracks.at(t, b) - tracks.at(t, a)),
            1e-6)
            << clip.name << " " << a;
      for (const auto& [a, b] : {std::pair{1, 2}, std::pair{13, 14}})
        ASSERT_LT(
            angle((posed.row(b) - posed.row(a)).transpose(), tracks.at(t, b) - tracks.at(t, a)),
            1e-6)
            << "the lines across";
      ASSERT_LT(angle((posed.row(16) + posed.row(17) - posed.row(1) - posed.row(2)).transpose(),
                      tracks.middle(t, 16, 17) - tracks.middle(t, 1, 2)),
                1e-4)
          << "the trunk";
    }
  }
}

// A giant of SMPL's proportions in centimetres: where it stands still, the figure does.
TEST(PositionFit, PlantedFeetStayPlanted) {
  for (const Clip& clip : dances()) {
    PointTracks tracks = tracks_of(clip);
    tracks.places *= 187;
    const PositionFit fit = fit_positions(tracks, 0.01, false);
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const JointPositions posed = joint_positions(fit.clip, t), truth = joint_positions(clip, t);
      for (const int foot : {7, 8, 10, 11})
        ASSERT_LT((posed.row(foot) - truth.row(foot)).norm(), 1e-6) << clip.name;
    }
    const PositionFit kept = fit_positions(tracks, 0.01, true);
    const JointPositions posed = joint_positions(kept.clip, 7), truth = joint_positions(clip, 7);
    EXPECT_LT(((posed.row(1) + posed.row(2)) - 1.87 * (truth.row(1) + truth.row(2))).norm(), 1e-6);
  }
}

// An arm that is straight for a while, over-stretched by noise, and bends again.
TEST(PositionFit, AStraightArmDoesNotTurnAboutItself) {
  Random random(13);
  Clip clip;
  clip.fps = 60;
  clip.poses = Poses::Zero(240, 72);
  clip.trans = Translations::Zero(240, 3);
  for (Eigen::Index t = 0; t < 240; ++t) {
    const double bend = std::max(0.0, std::abs(static_cast<double>(t) - 120) / 80 - 0.5);
    clip.poses(t, 3 * 18 + 1) = -bend;
    clip.poses(t, 3 * 19 + 1) = bend;
    clip.poses(t, 3 * 16 + 2) = -0.8 + 0.005 * static_cast<double>(t);
  }
  PointTracks tracks = tracks_of(clip, 22);
  for (const int wrist : {20, 21})
    for (Eigen::Index t = 0; t < 240; ++t)
      tracks.places.row(t).segment<3>(3 * wrist) += 0.01 * random_direction(random).transpose();
  const PositionFit fit = fit_positions(tracks, 1, false);
  double step = 0;
  for (Eigen::Index t = 1; t < 240; ++t)
    for (const int shoulder : {16, 17}) {
      const auto at = [&](Eigen::Index frame) {
        return quaternion_from_axis_angle(
            fit.clip.poses.row(frame).segment<3>(3 * shoulder).transpose());
      };
      step = std::max(step, geodesic_angle(at(t - 1), at(t)));
    }
  EXPECT_LT(step, 0.05);
}

// Where elbows and knees bend as hinges the upper bones' own turns come back, too.
TEST(PositionFit, FindsTheTurnOfBentLimbs) {
  Clip clip;
  clip.fps = 60;
  clip.poses = Poses::Zero(120, 72);
  clip.trans = Translations::Zero(120, 3);
  for (Eigen::Index t = 0; t < 120; ++t) {
    const double s = std::sin(0.05 * static_cast<double>(t));
    for (int side = 0; side < 2; ++side) {
      clip.poses.row(t).segment<3>(3 * (1 + side)) << -0.5 + 0.3 * s, 0.4 * s, 0.2;
      clip.poses(t, 3 * (4 + side)) = 1 + 0.4 * s;
      clip.poses.row(t).segment<3>(3 * (16 + side)) << 0.6 * s, 0.3, side == 0 ? -0.7 : 0.7;
      clip.poses(t, 3 * (18 + side) + 1) = (side == 0 ? -1 : 1) * (1.2 + 0.5 * s);
    }
  }
  const PositionFit fit = fit_positions(tracks_of(clip, 22), 1, false);
  double worst = 0;
  for (Eigen::Index t = 0; t < 120; ++t)
    for (const int joint : {1, 2, 4, 5, 16, 17, 18, 19})
      worst = std::max(
          worst,
          geodesic_angle(
              quaternion_from_axis_angle(clip.poses.row(t).segment<3>(3 * joint).transpose()),
              quaternion_from_axis_angle(fit.clip.poses.row(t).segment<3>(3 * joint).transpose())));
  EXPECT_LT(worst, 0.1);
}

TEST(PositionFit, APelvisBetweenTheHipsIsNotTakenForSmpls) {
  for (const Clip& clip : dances()) {
    PointTracks tracks = tracks_of(clip);
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      tracks.places.row(t).segment<3>(0) = tracks.middle(t, 1, 2).transpose();
    const PositionFit fit = fit_positions(tracks, 1, false);
    EXPECT_TRUE(fit.pelvis_is_middle);
    tracks = tracks_of(clip);
    EXPECT_LT(worst_distance(tracks, fit.clip), 1e-6) << clip.name;
    break;
  }
}

// Ears and nose tell where a head looks, heel and toes how a foot lies.
TEST(PositionFit, PointsOfHeadAndFeetTurnThem) {
  for (const Clip& clip : dances()) {
    PointTracks tracks = tracks_of(clip);
    std::vector<int> points = thesis_joints();
    for (const int point :
         {10, 11, int(kNose), int(kLeftEar), int(kRightEar), int(kLeftHeel), int(kRightHeel)})
      points.push_back(point);
    for (const int point :
         {int(kNose), int(kLeftEar), int(kRightEar), int(kLeftHeel), int(kRightHeel)})
      tracks.given[static_cast<std::size_t>(point)] = true;
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const auto world = joint_world_rotations(clip, t);
      const auto put = [&](int point, int joint, const Eigen::Vector3d& place) {
        tracks.places.row(t).segment<3>(3 * point) =
            (tracks.at(t, joint) + world[static_cast<std::size_t>(joint)] * place).transpose();
      };
      put(kLeftEar, 15, {0.075, 0.05, 0.02});
      put(kRightEar, 15, {-0.075, 0.05, 0.02});
      put(kNose, 15, {0, 0.05, 0.13});
      for (int side = 0; side < 2; ++side) {
        put(kLeftHeel + side, 7 + side, {0, -0.05, -0.05});
        put(10 + side, 7 + side, {side == 0 ? 0.02 : -0.02, -0.05, 0.15});
      }
    }
    const PositionFit fit = fit_positions(only(tracks, points), 1, false);
    for (Eigen::Index t = 0; t < clip.frames(); t += 7) {
      const auto truth = joint_world_rotations(clip, t), found = joint_world_rotations(fit.clip, t);
      ASSERT_LT((truth[15] - found[15]).norm(), 1e-6) << clip.name;
      for (int side = 0; side < 2; ++side) {
        const auto ankle = static_cast<std::size_t>(7 + side);
        const Eigen::Vector3d sole = (truth[ankle] * Eigen::Vector3d(0, 0, 1));
        ASSERT_GT(sole.dot(found[ankle] * Eigen::Vector3d(0, 0, 1)), 0.98) << clip.name;
      }
    }
  }
}

// Positions of an estimator jump by some millimetres from frame to frame: so may the figure, but
// nothing turns over.
TEST(PositionFit, NoiseDoesNotTurnJointsOver) {
  Random random(14);
  for (const Clip& clip : dances()) {
    PointTracks tracks = tracks_of(clip, 22);
    for (Eigen::Index i = 0; i < 66; ++i)
      for (Eigen::Index t = 0; t < clip.frames(); ++t)
        tracks.places(t, i) += random.uniform(-0.005, 0.005);
    const PositionFit fit = fit_positions(tracks, 1, false);
    EXPECT_LT(worst_distance(tracks, fit.clip), 0.05) << clip.name;
    EXPECT_LT(largest_step(fit.clip), largest_step(clip) + 0.6) << clip.name;
    EXPECT_LT(fit.from_source.root_mean_square, 1) << clip.name;
  }
}

TEST(BodyMeasure, FindsEveryUpAxisAndRefusesWhatIsNoBody) {
  const Clip clip = dances().front();
  for (const UpAxis up :
       {UpAxis::x, UpAxis::y, UpAxis::z, UpAxis::minus_x, UpAxis::minus_y, UpAxis::minus_z}) {
    PointTracks tracks = tracks_of(clip);
    const Eigen::Matrix3d back = turn_to_y_up(up).transpose();
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      for (int j = 0; j < kJoints; ++j)
        tracks.places.row(t).segment<3>(3 * j) = (back * tracks.at(t, j)).transpose();
    EXPECT_EQ(find_up(tracks).axis, up);
    EXPECT_TRUE(find_up(tracks).sure());
    EXPECT_NO_THROW(check_body(measure_body(tracks), "f"));
    EXPECT_NO_THROW(check_handedness(tracks, "f"));
    for (Eigen::Index c = 0; c < 3 * kPoints; c += 3) tracks.places.col(c) *= -1;
    EXPECT_THROW(check_handedness(tracks, "f"), DataError);
  }
  // Every joint where another one should be.
  PointTracks tracks = tracks_of(clip);
  const auto right = tracks.places;
  for (int j = 0; j < kJoints; ++j)
    tracks.places.middleCols<3>(3 * j) = right.middleCols<3>(3 * ((7 * j + 3) % kJoints));
  EXPECT_THROW(check_body(measure_body(tracks), "f"), DataError);
}

}  // namespace
}  // namespace mocaplm::position_fit_test
