#include "motion/formats/bvh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <limits>

#include "common/angles.h"
#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "motion/formats/retarget.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::bvh_test {
namespace {

const char* const kSmall =
    "HIERARCHY\n"
    "ROOT Hips\n"
    "{\n"
    "  OFFSET 1 2 3\n"
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "  JOINT Left Arm\n"
    "  {\n"
    "    OFFSET 0 1.5e1 -2\n"
    "    CHANNELS 2 Yrotation Xrotation\n"
    "    End Site\n"
    "    {\n"
    "      OFFSET 4 0 0\n"
    "    }\n"
    "  }\n"
    "  JOINT Fixed { OFFSET 7 8 9 JOINT Tip { CHANNELS 1 Yposition OFFSET 1 1 1 } }\n"
    "}\n"
    "MOTION\n"
    "Frames: 2\n"
    "Frame Time: 0.0333333\n"
    "1 2 3 10 20 30 40 50 60\n"
    "+1 -2 3e0 1E1 .5 5. 0 -0 1e-400\n";

std::string error_of(const std::string& text) {
  try {
    parse_bvh(text, "walk.bvh");
  } catch (const DataError& error) {
    return error.what();
  }
  return "";
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Bvh, ReadsHierarchyAndMotion) {
  const Bvh bvh = parse_bvh(kSmall, "small");
  ASSERT_EQ(bvh.joints.size(), 4u);
  EXPECT_EQ(bvh.joints[0].name, "Hips");
  EXPECT_EQ(bvh.joints[0].parent, -1);
  EXPECT_EQ(bvh.joints[0].offset, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(bvh.joints[1].name, "Left Arm");
  EXPECT_EQ(bvh.joints[1].parent, 0);
  EXPECT_EQ(bvh.joints[1].offset, Eigen::Vector3d(0, 15, -2));
  EXPECT_EQ(bvh.joints[1].channels,
            (std::vector<BvhChannel>{BvhChannel::y_rotation, BvhChannel::x_rotation}));
  EXPECT_EQ(bvh.joints[1].first_channel, 6);
  ASSERT_EQ(bvh.joints[1].end_sites.size(), 1u);
  EXPECT_EQ(bvh.joints[1].end_sites[0], Eigen::Vector3d(4, 0, 0));
  EXPECT_EQ(bvh.joints[2].name, "Fixed");
  EXPECT_TRUE(bvh.joints[2].channels.empty());
  EXPECT_EQ(bvh.joints[3].parent, 2);
  EXPECT_EQ(bvh.joints[3].first_channel, 8);
  EXPECT_EQ(bvh.fps, 30);
  ASSERT_EQ(bvh.frames(), 2);
  ASSERT_EQ(bvh.channels(), 9);
  EXPECT_EQ(bvh.values(0, 8), 60);
  const std::vector<double> second = {1, -2, 3, 10, .5, 5, 0, 0, 0};
  for (int c = 0; c < 9; ++c) EXPECT_EQ(bvh.values(1, c), second[static_cast<std::size_t>(c)]);
  EXPECT_EQ(bvh.joint("Tip"), 3);
  EXPECT_EQ(bvh.joint("tip"), -1);
}

TEST(Bvh, TakesTabsCarriageReturnsCaseAndByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : std::string(kSmall))
    text += c == '\n' ? "\r\n" : c == ' ' ? " \t" : std::string(1, c);
  text = with(text, "Left \tArm", "LeftArm");
  text = with(text, "HIERARCHY", "Hierarchy");
  text = with(text, "Xposition", "XPOSITION");
  text = with(text, "Frames:", "Frames :");
  text += "\r\n \r\n";
  const Bvh a = parse_bvh(text, "crlf"), b = parse_bvh(kSmall, "lf");
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.joints[1].name, "LeftArm");
  EXPECT_EQ(a.fps, 30);
}

TEST(Bvh, FrameRateIsWhatTheDigitsMean) {
  const std::vector<std::pair<std::string, double>> cases = {{"0.0333333", 30},
                                                             {"0.033333", 30},
                                                             {"0.0333", 30},
                                                             {".04", 25},
                                                             {"0.00833333", 120},
                                                             {"0.0083333", 120},
                                                             {"0.041667", 24},
                                                             {"0.0417", 24},
                                                             {"1", 1},
                                                             {"0.016667", 60},
                                                             {"0.01666667", 60},
                                                             {"8.333333333e-3", 120},
                                                             {"0.03336670003", 29.97},
                                                             {"0.5", 2},
                                                             {"2", 0.5}};
  for (const auto& [text, fps] : cases)
    EXPECT_NEAR(parse_bvh(with(kSmall, "0.0333333", text), "rate").fps, fps, 1e-9 * fps) << text;
  // 23.976 is not 24, and 29.97 is not 30.
  EXPECT_NEAR(parse_bvh(with(kSmall, "0.0333333", "0.041708"), "rate").fps, 23.976, 1e-3);
  EXPECT_NEAR(parse_bvh(with(kSmall, "0.0333333", "0.033367"), "rate").fps, 29.97, 1e-3);
}

// Plain and slow: 4 x 4 matrices, one for each channel.
Eigen::Affine3d slow_pose(const Bvh& bvh, Eigen::Index frame, int index) {
  const BvhJoint& joint = bvh.joints[static_cast<std::size_t>(index)];
  Eigen::Vector3d position = joint.offset;
  Eigen::Affine3d turn = Eigen::Affine3d::Identity();
  for (std::size_t c = 0; c < joint.channels.size(); ++c) {
    const double value = bvh.values(frame, joint.first_channel + static_cast<int>(c));
    const int kind = static_cast<int>(joint.channels[c]);
    if (kind < 3)
      position[kind] = value;
    else
      turn = turn * Eigen::AngleAxisd(value * kPi / 180, Eigen::Vector3d::Unit(kind - 3));
  }
  const Eigen::Affine3d local = Eigen::Translation3d(position) * turn;
  return joint.parent < 0 ? local : slow_pose(bvh, frame, joint.parent) * local;
}

TEST(Bvh, KinematicsOfAnyChannelOrderAndSubset) {
  Random random(5);
  for (int trial = 0; trial < 30; ++trial) {
    Bvh bvh;
    const int joints = 1 + static_cast<int>(random.below(12));
    int channels = 0;
    for (int i = 0; i < joints; ++i) {
      BvhJoint joint;
      joint.parent = i == 0 ? -1 : static_cast<int>(random.below(static_cast<std::uint64_t>(i)));
      joint.offset = 10 * random_direction(random);
      std::vector<int> kinds = {0, 1, 2, 3, 4, 5};
      random.shuffle(kinds);
      kinds.resize(random.below(7));
      for (const int kind : kinds) joint.channels.push_back(static_cast<BvhChannel>(kind));
      joint.first_channel = channels;
      channels += static_cast<int>(kinds.size());
      bvh.joints.push_back(joint);
    }
    bvh.values.resize(3, channels);
    for (Eigen::Index i = 0; i < bvh.values.size(); ++i)
      bvh.values.data()[i] = random.uniform(-300, 300);
    BvhPose pose;
    for (Eigen::Index t = 0; t < 3; ++t) {
      pose_bvh(bvh, t, pose);
      for (int i = 0; i < joints; ++i) {
        const Eigen::Affine3d slow = slow_pose(bvh, t, i);
        EXPECT_TRUE(pose.rotations[static_cast<std::size_t>(i)].isApprox(slow.linear(), 1e-12));
        EXPECT_LT((pose.positions[static_cast<std::size_t>(i)] - slow.translation()).norm(), 1e-9);
      }
    }
  }
}

TEST(Bvh, SomeJointsArePosedAsAllAreAndTheOthersLeftAlone) {
  const Bvh bvh = parse_bvh(kSmall, "small");
  BvhPose all, some;
  pose_bvh(bvh, 0, all);
  const Eigen::Vector3d left_alone(9, 9, 9);
  some.positions.assign(bvh.joints.size(), left_alone);
  pose_bvh(bvh, 0, {0, 2, 3}, some);
  for (const std::size_t i : {0, 2, 3}) {
    EXPECT_EQ(some.positions[i], all.positions[i]);
    EXPECT_EQ(some.rotations[i], all.rotations[i]);
  }
  EXPECT_EQ(some.positions[1], left_alone);
}

TEST(Bvh, PositionChannelsReplaceTheOffset) {
  const Bvh bvh = parse_bvh(kSmall, "small");
  BvhPose pose;
  pose_bvh(bvh, 1, pose);
  EXPECT_EQ(pose.positions[0], Eigen::Vector3d(1, -2, 3));  // not OFFSET + channels
  EXPECT_EQ(rest_bvh(bvh).positions[1], Eigen::Vector3d(1, 17, 1));
}

TEST(Bvh, ErrorsNameThePlace) {
  struct Case {
    std::string from, to, message;
  };
  const std::vector<Case> cases = {
      {"HIERARCHY", "HIERARCH", "walk.bvh: line 1: found \"HIERARCH\" where HIERARCHY is expected"},
      {"OFFSET 1 2 3", "OFFSET 1 two 3",
       "line 4: found \"two\" where the OFFSET's y (a finite number)"},
      {"OFFSET 1 2 3", "OFFSET 1 nan 3", "line 4: found \"nan\""},
      {"OFFSET 1 2 3", "OFFSET 1 1e999 3", "line 4"},
      {"CHANNELS 6", "CHANNELS 7", "line 5: found \"7\" where the number of CHANNELS"},
      {"CHANNELS 6", "CHANNELS -1", "line 5"},
      {"Zrotation Xrotation Yrotation\n  J", "Zrotation Xrotation Zrotation\n  J",
       "has the channel Zrotation twice"},
      {"Yposition", "Wposition", "found \"Wposition\" where one of Xposition"},
      {"JOINT Fixed", "JOINT ", "the joint's name"},
      {"End Site", "End Sight", "where Site is expected"},
      {"MOTION", "}\nMOTION", "where MOTION is expected"},
      {"Frames: 2", "Frames: -3", "the number of frames"},
      {"Frames: 2", "Frames: 2.5", "the number of frames"},
      {"Frames: 2", "Frames: 99999999999999999999999", "line 18"},
      {"0.0333333", "0", "frame time \"0\""},
      {"0.0333333", "-1", "frame time"},
      {"0.0333333", "inf", "the frame time in seconds"},
      {"10 20 30", "10 nan 30", "line 20, frame 0, joint Hips, Xrotation: found \"nan\""},
      {"40 50 60", "40 50 6x", "line 20, frame 0, joint Tip, Yposition: found \"6x\""},
      {"40 50 60", "40 1e300 60", "line 20, frame 0, joint Left Arm, Xrotation"},
      {"40 50 60", "40 50", "line 20, frame 0: the line ends after 8 of 9 values"},
      {"40 50 60", "40 50 60 70", "frame 0: has more than the 9 values"},
  };
  for (const Case& c : cases)
    EXPECT_NE(error_of(with(kSmall, c.from, c.to)).find(c.message), std::string::npos)
        << c.to << " gave: " << error_of(with(kSmall, c.from, c.to));
  EXPECT_NE(error_of("").find("the file ends where HIERARCHY is expected"), std::string::npos);
}

TEST(Bvh, DepthAndJointBombsAreRefused) {
  std::string deep = "HIERARCHY\nROOT j\n{\n", wide = deep;
  for (int i = 0; i < 100000; ++i) deep += "JOINT j" + std::to_string(i) + "\n{\n";
  EXPECT_NE(error_of(deep).find("nested more than"), std::string::npos);
  for (int i = 0; i < 100000; ++i) wide += "JOINT j" + std::to_string(i) + "\n{\n}\n";
  EXPECT_NE(error_of(wide).find("more than 4096 joints"), std::string::npos);
  EXPECT_NE(error_of("HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 9\nFrame Time: 1\n")
                .find("no motion"),
            std::string::npos);
}

TEST(Bvh, TruncatedAtEveryByteIsRefusedWholeOrSaid) {
  const std::string text = kSmall;
  const Bvh whole = parse_bvh(text, "walk.bvh");
  // Cut inside the last number what is left is a number, so those few bytes cannot be told.
  const std::size_t first_frame_ends = text.find("60\n") + 2, last_number = text.rfind(' ') + 1;
  for (std::size_t n = 0; n < last_number; ++n) {
    // Within the last number of the first frame it cannot be told either.
    if (n < first_frame_ends - 1) {
      EXPECT_NE(error_of(text.substr(0, n)), "") << n;
      continue;
    }
    const Bvh cut = parse_bvh(text.substr(0, n), "walk.bvh");
    ASSERT_EQ(cut.frames(), 1) << n;
    if (n >= first_frame_ends) EXPECT_EQ(cut.values, whole.values.topRows(1)) << n;
    ASSERT_FALSE(cut.remarks.empty()) << n;
    EXPECT_EQ(cut.remarks.back().kind, "frames announced") << n;
    EXPECT_EQ(cut.remarks.size(), n <= first_frame_ends + 1 ? 1u : 2u) << n;
  }
}

TEST(Bvh, RandomDamageNeverCrashes) {
  Random random(11);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = kSmall;
    for (std::uint64_t k = 1 + random.below(4); k > 0; --k) {
      const std::size_t at = random.below(text.size());
      switch (random.below(4)) {
        case 0:
          text[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          text[at] = "0123456789.-+eE{} \n"[random.below(19)];
          break;
        case 2:
          text.erase(at, 1 + random.below(10));
          break;
        default:
          text.insert(at, text.substr(random.below(text.size()), random.below(30)));
      }
      if (text.empty()) text = " ";
    }
    try {
      const Bvh bvh = parse_bvh(text, "damaged");
      EXPECT_TRUE(bvh.values.allFinite());
      BvhPose pose;
      pose_bvh(bvh, 0, pose);
    } catch (const DataError&) {
    }
  }
}

// Largest angle between two clips' joint rotations, radians.
double rotation_error(const Clip& a, const Clip& b) {
  double worst = 0;
  for (Eigen::Index t = 0; t < a.frames(); ++t)
    for (int j = 0; j < kJoints; ++j)
      worst = std::max(
          worst,
          geodesic_angle(quaternion_from_axis_angle(a.poses.row(t).segment<3>(3 * j).transpose()),
                         quaternion_from_axis_angle(b.poses.row(t).segment<3>(3 * j).transpose())));
  return worst;
}

TEST(BvhWriter, RoundTripsAnyRotation) {
  Random random(3);
  Clip clip = random_clip(random, 40, 60, 3.1415);
  // Euler angles' hard cases: the middle angle (X) at and near a quarter turn, and half turns.
  for (int j = 0; j < kJoints; ++j) {
    clip.poses.row(0).segment<3>(3 * j) << kPi / 2, 0, 0;
    clip.poses.row(1).segment<3>(3 * j) << -kPi / 2 + 1e-7 * j, 0, 0;
    clip.poses.row(2).segment<3>(3 * j) =
        axis_angle_from_matrix(
            matrix_from_euler({1, kPi / 2 - std::pow(10., -j / 2.), 2}, {2, 0, 1}))
            .transpose();
    clip.poses.row(3).segment<3>(3 * j) = kPi * random_direction(random).transpose();
    clip.poses.row(4).segment<3>(3 * j).setZero();
  }
  RetargetReport report;
  const Clip back = retarget_bvh(parse_bvh(bvh_text(clip), "out"), "out.bvh", {}, &report);
  EXPECT_EQ(report.scheme, "smpl");
  EXPECT_LT(report.mean_degrees, 1e-4);
  EXPECT_EQ(back.fps, 60);
  EXPECT_LT(rotation_error(clip, back), 1e-7);
  EXPECT_LT((clip.trans - back.trans).cwiseAbs().maxCoeff(), 1e-8);
  const Clip again = retarget_bvh(parse_bvh(bvh_text(back), "out"), "out.bvh");
  EXPECT_LT((again.poses - back.poses).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BvhWriter, SmoothMotionComesBackNumberForNumber) {
  Random random(4);
  Clip clip = random_clip(random, 1, 29.97, 1.5);
  const Eigen::Index frames = 120;
  const Poses first = clip.poses, step = 0.02 * random_clip(random, 1, 30, 1).poses;
  clip.poses.resize(frames, 72);
  clip.trans.setZero(frames, 3);
  for (Eigen::Index t = 0; t < frames; ++t)
    clip.poses.row(t) = first + static_cast<double>(t) * step;
  const std::string text = bvh_text(clip);
  const Bvh bvh = parse_bvh(text, "out");
  const Clip back = retarget_bvh(bvh, "out.bvh");
  EXPECT_LT((clip.poses - back.poses).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_EQ(back.fps, 29.97);
  // Euler curves do not jump either.
  const Eigen::Index last = frames - 1;
  EXPECT_LT((bvh.values.bottomRows(last) - bvh.values.topRows(last)).cwiseAbs().maxCoeff(), 60);
}

TEST(BvhWriter, IsInCentimetres) {
  Random random(6);
  const Clip clip = random_clip(random, 3, 30);
  const Bvh bvh = parse_bvh(bvh_text(clip), "out");
  BvhPose pose;
  for (Eigen::Index t = 0; t < 3; ++t) {
    pose_bvh(bvh, t, pose);
    const JointPositions metres = joint_positions(clip, t);
    for (int j = 0; j < kJoints; ++j) {
      const auto at =
          static_cast<std::size_t>(bvh.joint(joint_names()[static_cast<std::size_t>(j)]));
      EXPECT_LT((pose.positions[at].transpose() - 100 * metres.row(j)).norm(), 1e-4);
    }
  }
}

TEST(BvhWriter, RefusesAnUnsoundClipAndKeepsTheOldFile) {
  Random random(7);
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "mocaplm_writer.bvh";
  Clip clip = random_clip(random, 3, 30);
  write_bvh(path, clip);
  const std::string before = read_file(path);
  EXPECT_EQ(before, bvh_text(clip));
  clip.poses(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_bvh(path, clip), DataError);
  EXPECT_EQ(read_file(path), before);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace mocaplm::bvh_test
