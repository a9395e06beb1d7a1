#include "motion/formats/positions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/formats/joint_csv.h"
#include "motion/formats/joint_vocabulary.h"
#include "motion/formats/position_helpers.h"
#include "motion/formats/position_rate.h"
#include "motion/helpers.h"
#include "motion/import/sources.h"

namespace mocaplm::positions_test {
namespace {

TEST(Positions, HumanMl3dArraysComeIn) {
  const Scratch folder;
  const Clip clip = dance();
  const auto path = folder.put("a.npy", array_bytes(clip, 22));
  ReadReport report;
  const Clip read = read_clip(path, {}, &report);
  EXPECT_EQ(read.name, "a");
  EXPECT_EQ(read.fps, 20);
  EXPECT_LT(worst_distance(read, clip), 1e-3);
  EXPECT_TRUE(has_remark(report, "frame rate", "20"));
  EXPECT_TRUE(has_remark(report, "up axis", "y is up"));
  EXPECT_TRUE(has_remark(report, "unit", "metres"));
  EXPECT_TRUE(has_remark(report, "residual", "0.00 cm"));
  EXPECT_EQ(read_clip(path, with_fps(30)).fps, 30);
}

TEST(Positions, EveryLayoutOfAnArrayIsTheSame) {
  const Scratch folder;
  const Clip clip = dance();
  const auto n = static_cast<std::size_t>(clip.frames());
  const std::vector<double> values = places(clip, 22), values24 = places(clip, 24);
  const std::vector<std::vector<std::size_t>> shapes = {
      {n, 22, 3}, {n, 66}, {1, n, 22, 3}, {1, n, 66}};
  for (const auto& shape : shapes) {
    const Clip read = read_clip(folder.put("a.npy", npy_bytes(values.data(), shape)));
    EXPECT_LT(worst_distance(read, clip), 1e-3);
  }
  const std::vector<std::vector<std::size_t>> shapes24 = {{n, 24, 3}, {n, 72}};
  for (const auto& shape : shapes24) {
    const auto path = folder.put("a.npy", npy_bytes(values24.data(), shape));
    EXPECT_TRUE(contains(refusal([&] { read_clip(path); }), "says no frame rate"));
    EXPECT_LT(worst_distance(read_clip(path, with_fps(60)), clip, 24), 1e-3);
  }
  // Column-major: all x of a joint's frames stand together.
  std::vector<double> turned(values.size());
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t j = 0; j < 22; ++j)
      for (std::size_t c = 0; c < 3; ++c)
        turned[t + n * (j + 22 * c)] = values[3 * (22 * t + j) + c];
  std::string bytes = npy_bytes(turned.data(), {n, 22, 3});
  bytes.replace(bytes.find("False"), 5, "True ");
  EXPECT_LT(worst_distance(read_clip(folder.put("a.npy", bytes)), clip), 1e-3);
}

TEST(Positions, AnyAxisAndUnitIsFound) {
  const Scratch folder;
  const Clip clip = dance();
  for (const std::string name : {"x", "y", "z", "-x", "-y", "-z"})
    for (const double unit : {1.0, 0.01, 0.001, 0.0254, 0.0606}) {
      const Eigen::Matrix3d back = turn_to_y_up(up_axis_of(name)).transpose();
      const auto path =
          folder.put("a.npy", array_bytes(clip, 22, [&](const auto& p) {
                       return Eigen::RowVector3d((back * p.transpose()).transpose() / unit);
                     }));
      ReadReport report;
      EXPECT_LT(worst_distance(read_clip(path, {}, &report), clip), 1e-3) << name << " " << unit;
      EXPECT_TRUE(has_remark(report, "up axis", name + " is up"));
      EXPECT_TRUE(has_remark(report, "unit"));
    }
}

// Somebody lies on the back, head towards +z, in a file as HumanML3D writes it.
TEST(Positions, WhoLiesInHumanMl3dStaysLying) {
  const Scratch folder;
  const Clip clip = dance();
  Eigen::Matrix3d lie;  // up to +z, forward to the ceiling
  lie << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  ASSERT_NEAR(lie.determinant(), 1, 1e-12);
  const Eigen::Vector3d head = lie * Eigen::Vector3d::UnitY();
  double lowest = 1e9;
  const auto turned = [&](const Eigen::RowVector3d& p) {
    return Eigen::RowVector3d((lie * p.transpose()).transpose());
  };
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions p = joint_positions(clip, t);
    for (int j = 0; j < 22; ++j) lowest = std::min(lowest, turned(p.row(j)).y());
  }
  const Eigen::RowVector3d pelvis = turned(joint_positions(clip, 0).row(0));
  const auto path = folder.put(
      "a.npy", array_bytes(clip, 22, [&](const auto& p) {
        return Eigen::RowVector3d(turned(p) - Eigen::RowVector3d(pelvis.x(), lowest, pelvis.z()));
      }));
  ReadReport report;
  const Clip read = read_clip(path, {}, &report);
  EXPECT_TRUE(has_remark(report, "up axis", "HumanML3D"));
  const JointPositions posed = joint_positions(read, 5);
  EXPECT_GT((posed.row(15) - posed.row(0)).dot(head.transpose()), 0.4) << "not set upright";
}

TEST(Positions, ToldAxisAndUnitWin) {
  const Scratch folder;
  const Clip clip = dance();
  const auto path = folder.put("a.npy", array_bytes(clip, 22));
  ReadOptions options;
  options.up = UpAxis::z;
  options.unit = 0.01;
  ReadReport report;
  const Clip read = read_clip(path, options, &report);
  const JointPositions posed = joint_positions(read, 0);
  EXPECT_LT(std::abs(posed(15, 1) - posed(0, 1)), 0.3) << "it lies down";
  EXPECT_FALSE(has_remark(report, "up axis"));
  EXPECT_FALSE(has_remark(report, "unit"));
  options.keep_path = true;
  const Clip kept = read_clip(path, options);
  EXPECT_NEAR(kept.trans.norm(), 0.01 * read.trans.norm(), 0.3 * std::sqrt(read.frames()));
}

// What convert writes is read back, whatever the motion: Y is up by the format.
TEST(Positions, OurOwnTablesComeBack) {
  const Scratch folder;
  for (const double fps : {59.94005994, 30.0, 120.0, 25.5}) {
    Clip clip = dance("BR");
    clip.fps = fps;
    write_joint_csv(folder / "a.csv", clip);
    ReadReport report;
    const Clip read = read_clip(folder / "a.csv", {}, &report);
    EXPECT_LT(worst_distance(read, clip, 24), 1e-5);
    EXPECT_NEAR(read.fps, fps, 1e-4);
    EXPECT_FALSE(has_remark(report, "up axis") || has_remark(report, "unit"));
  }
  // Upside down for all of it.
  Clip clip = dance();
  for (Eigen::Index t = 0; t < clip.frames(); ++t)
    clip.poses.row(t).head<3>() << 0, 0, 3.14159265358979;
  write_joint_csv(folder / "b.csv", clip);
  ReadReport report;
  EXPECT_LT(worst_distance(read_clip(folder / "b.csv", {}, &report), clip, 24), 1e-5);
  EXPECT_TRUE(has_remark(report, "up axis", "-y"));
}

std::string csv_of(const Clip& clip, const std::vector<std::pair<int, std::string>>& joints,
                   const std::string& axes, char delimiter, double scale = 1) {
  std::string text = "time";
  for (const auto& [joint, name] : joints)
    for (int c = 0; c < 3; ++c)
      text += delimiter + name + axes.substr(2 * static_cast<std::size_t>(c), 2);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    text += "\n" + format_fixed(static_cast<double>(t) / clip.fps, 3);
    const JointPositions places = joint_positions(clip, t);
    for (const auto& [joint, name] : joints)
      for (int c = 0; c < 3; ++c) text += delimiter + format_fixed(scale * places(joint, c), 6);
  }
  return text;
}

TEST(Positions, TablesOfOtherProgramsComeIn) {
  const Scratch folder;
  const Clip clip = dance();
  for (const auto& [axes, delimiter] :
       {std::pair{"_x_y_z", ','}, std::pair{".X.Y.Z", ';'}, std::pair{" X Y Z", '\t'}}) {
    ReadReport report;
    const Clip read = read_clip(
        folder.put("a.csv", csv_of(clip, open_pose_names(), axes, delimiter, 1000)), {}, &report);
    EXPECT_EQ(read.fps, 60);
    EXPECT_TRUE(has_remark(report, "unit", "millimetres"));
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const JointPositions p = joint_positions(read, t), q = joint_positions(clip, t);
      for (const int j : {1, 2, 4, 5, 7, 8, 10, 11}) ASSERT_LT((p.row(j) - q.row(j)).norm(), 1e-4);
      for (const int j : {16, 17, 18, 19, 20, 21}) ASSERT_LT((p.row(j) - q.row(j)).norm(), 0.08);
    }
  }
}

TEST(Positions, WhatIsNoPositionIsRefusedByName) {
  const Scratch folder;
  const std::vector<double> values(40 * 300, 0.5);
  const auto refused = [&](const std::vector<std::size_t>& shape) {
    return refusal([&] { read_clip(folder.put("a.npy", npy_bytes(values.data(), shape))); });
  };
  EXPECT_TRUE(contains(refused({40, 263}), "HumanML3D's features"));
  EXPECT_TRUE(contains(refused({40, 251}), "KIT-ML's features"));
  EXPECT_TRUE(contains(refused({10, 17, 3}), "Human3.6M or COCO"));
  EXPECT_TRUE(contains(refused({10, 25, 3}), "BODY_25"));
  EXPECT_TRUE(contains(refused({3, 10, 22, 3}), "several people"));
  EXPECT_TRUE(contains(refused({2, 22, 3, 10}), "time last"));
  EXPECT_TRUE(contains(refused({40, 13}), "none of positions"));
  EXPECT_TRUE(contains(refused({100}), "none of positions"));
  EXPECT_TRUE(contains(refused({0, 22, 3}), "frames"));
  // All in one point, and rotations in place of positions.
  EXPECT_TRUE(contains(refused({10, 22, 3}), "the joints of a person"));
  const Clip clip = dance();
  const auto path = folder.put(
      "b.npy", npy_bytes(clip.poses.data(), {static_cast<std::size_t>(clip.frames()), 72}));
  EXPECT_TRUE(contains(refusal([&] { read_clip(path, with_fps(60)); }), "joints of a person"));
  // Left and right exchanged.
  const auto mirrored = folder.put("c.npy", array_bytes(clip, 22, [](const auto& p) {
                                     return Eigen::RowVector3d(-p.x(), p.y(), p.z());
                                   }));
  EXPECT_TRUE(contains(refusal([&] { read_clip(mirrored); }), "mirrored"));
}

TEST(Positions, GapsAreNamedOrFilled) {
  const Scratch folder;
  const Clip clip = dance();
  const auto file = [&](int joint, Eigen::Index first, Eigen::Index count, double value) {
    std::vector<double> values = places(clip, 22);
    for (Eigen::Index t = first; t < first + count; ++t)
      for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(66 * t + 3 * joint + c)] = value;
    return folder.put("a.npy",
                      npy_bytes(values.data(), {static_cast<std::size_t>(clip.frames()), 22, 3}));
  };
  ReadOptions fill;
  fill.fill_gaps = true;
  fill.fps = 60;
  for (const double value : {std::nan(""), 0.0}) {
    const auto path = file(5, 30, 4, value);
    const std::string text = refusal([&] { read_clip(path); });
    EXPECT_TRUE(contains(text, "frame 30") && contains(text, "right_knee") &&
                contains(text, "--fill-gaps"))
        << text;
    ReadReport report;
    EXPECT_LT(worst_distance(read_clip(path, fill, &report), clip), 0.05);
    EXPECT_TRUE(has_remark(report, "gaps filled", "4 missing"));
  }
  EXPECT_LT(worst_distance(read_clip(file(5, 0, 3, std::nan("")), fill), clip), 0.2);
  const std::string text = refusal([&] { read_clip(file(5, 20, 70, std::nan("")), fill); });
  EXPECT_TRUE(contains(text, "frame 20") && contains(text, "right_knee")) << text;
  ReadReport report;
  read_clip(file(10, 20, 70, std::nan("")), fill, &report);
  EXPECT_TRUE(has_remark(report, "joints left out", "left_foot"));
}

TEST(Positions, RatesOfTimesAreTheRoundestThatFit) {
  std::vector<Remark> remarks;
  for (const double rate : {60.0, 59.94, 60 / 1.001, 24 / 1.001, 29.97, 30.0, 120.0, 20.0, 12.5})
    for (const int decimals : {3, 4, 6}) {
      std::vector<double> times;
      const double scale = std::pow(10.0, decimals);
      for (int t = 0; t < 2000; ++t) times.push_back(std::round(t / rate * scale) / scale);
      EXPECT_NEAR(*rate_of_times(times, decimals, "f", remarks), rate, 1e-3 * rate * 0.1);
    }
  EXPECT_TRUE(remarks.empty());
  EXPECT_FALSE(rate_of_times({1.0}, 3, "f", remarks));
  EXPECT_TRUE(contains(refusal([&] { rate_of_times({0, 1, 1}, 3, "f", remarks); }), "frame 2"));
  EXPECT_TRUE(contains(refusal([&] {
                         rate_of_times({0, 1, 2, 3, 9, 10}, 3, "f", remarks);
                       }),
                       "off an even"));
}

TEST(Positions, NamesInAnyWriting) {
  const std::vector<std::vector<std::string>> vocabularies = {
      {"RHip", "RKnee", "RAnkle", "LHip", "LKnee", "LAnkle", "RShoulder", "RElbow", "RWrist",
       "LShoulder", "LElbow", "LWrist"},
      {"hip_r", "knee.R", "ankle R", "hip_l", "knee.L", "ankle L", "shoulder_r", "elbow_r",
       "wrist_r", "shoulder_l", "elbow_l", "wrist_l"},
      {"HipRight", "KneeRight", "AnkleRight", "HipLeft", "KneeLeft", "AnkleLeft", "ShoulderRight",
       "ElbowRight", "WristRight", "ShoulderLeft", "ElbowLeft", "WristLeft"},
      {"S1:RHJC", "S1:RKJC", "S1:RAJC", "S1:LHJC", "S1:LKJC", "S1:LAJC", "S1:RSJC", "S1:REJC",
       "S1:RWJC", "S1:LSJC", "S1:LEJC", "S1:LWJC"},
      {"RightUpLeg", "RightLeg", "RightFoot", "LeftUpLeg", "LeftLeg", "LeftFoot", "RightArm",
       "RightForeArm", "RightHand", "LeftArm", "LeftForeArm", "LeftHand"}};
  const int order[] = {2, 5, 8, 1, 4, 7, 17, 19, 21, 16, 18, 20};
  for (const auto& names : vocabularies) {
    const PointNames points = find_points(names);
    EXPECT_TRUE(points.missing.empty()) << names[0] << ": " << join(points.missing, ", ");
    for (int i = 0; i < 12; ++i)
      EXPECT_EQ(points.index[static_cast<std::size_t>(order[i])], i) << names[0];
  }
}

TEST(Positions, OtherTablesInAFolderAreNoMotion) {
  const Scratch folder;
  const Clip clip = dance();
  write_joint_csv(folder / "a.csv", clip);
  folder.put("labels.csv", "name,genre\na,waack\n");
  folder.put("strokes.csv", "trajectory,time,x,y\n0,0,1,2\n");
  folder.put("b.npy", array_bytes(clip, 22));
  const std::vector<double> values(1000, 0.0);
  folder.put("mean.npy", npy_bytes(values.data(), {263}));
  folder.put("features.npy", npy_bytes(values.data(), {2, 263}));
  folder.put("empty.csv", "");
  const Sources sources = find_sources({folder.path().string()}, {});
  ASSERT_EQ(sources.files.size(), 2u);
  EXPECT_EQ(sources.files[0].path.filename(), "a.csv");
  EXPECT_EQ(sources.files[1].path.filename(), "b.npy");
  EXPECT_EQ(sources.ignored, 5u);
}

// Cut off, with a byte changed, or doubled: an error for people or a sound clip.
TEST(Positions, DamagedFilesAreRefused) {
  const Scratch folder;
  Random random(17);
  Clip clip = slice(dance(), 0, 8);
  std::vector<std::pair<int, std::string>> smpl;
  for (int j = 0; j < 22; ++j) smpl.emplace_back(j, joint_names()[static_cast<std::size_t>(j)]);
  const std::pair<const char*, std::string> files[] = {{"a.npy", array_bytes(clip, 22)},
                                                       {"a.csv", joint_csv(clip)},
                                                       {"a.trc", trc_of(clip, smpl, "m", 1)}};
  for (const auto& [name, bytes] : files)
    for (int i = 0; i < 150; ++i) {
      std::string broken = bytes;
      const std::size_t at =
          random.below(i % 2 == 0 ? std::min<std::size_t>(400, bytes.size()) : bytes.size());
      if (i % 3 == 0)
        broken.resize(at);
      else
        broken[at] = static_cast<char>(random.below(256));
      const auto path = folder.put(name, broken);
      reads_or_refuses([&] { check_clip(read_clip(path), name); }, name);
    }
}

TEST(Positions, TheSharedCaseStands) {
  const auto path = std::filesystem::path(MOCAPLM_SOURCE_DIR) /
                    "../shared/cases/smpl-files-of-other-tools/humanml3d_joints.npy";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const Clip clip = read_clip(path);
  EXPECT_EQ(clip.fps, 20);
  ASSERT_EQ(clip.frames(), 2);
  // A T-pose of a body whose bones are all upright: limbs as in the file, trunk and head above the
  // pelvis, feet on the floor.
  const JointPositions posed = joint_positions(clip, 1);
  const auto near = [&](const Eigen::RowVector3d& a, double x, double y, double z, double by) {
    EXPECT_LT((a - Eigen::RowVector3d(x, y, z)).norm(), by) << a;
  };
  const auto way = [&](int a, int b) {
    return Eigen::RowVector3d((posed.row(b) - posed.row(a)).normalized());
  };
  near(way(2, 1), 1, 0, 0, 1e-3);
  near(way(17, 16), 1, 0, 0, 5e-3);  // SMPL's own shoulders are not quite alike
  for (const int j : {16, 18}) near(way(j, j + 2), 1, 0, 0, 1e-3);
  for (const int j : {17, 19}) near(way(j, j + 2), -1, 0, 0, 1e-3);
  for (const int j : {1, 2, 4, 5}) near(way(j, j + 3), 0, -1, 0, 1e-3);
  near(posed.row(15) - posed.row(0), 0.01, 0.58, 0.01, 0.08);
  near(posed.row(0), 0, 0.95, 0, 0.03);
  EXPECT_NEAR(posed(10, 1), 0.026, 0.015);
  EXPECT_NEAR(posed(11, 1), 0.026, 0.015);
}

}  // namespace
}  // namespace mocaplm::positions_test
