// Files of joint positions for the tests, and what is asked of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/text.h"
#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/formats/npy.h"
#include "motion/skeleton.h"
#include "motion/synth.h"

namespace mocaplm {

inline Clip dance(const std::string& genre = "WA") {
  SynthConfig config;
  config.genres = {genre};
  config.seconds = 2;
  return make_dance(plan_dances(config).front(), config);
}

using Place3 = std::function<Eigen::RowVector3d(const Eigen::RowVector3d&)>;
inline Eigen::RowVector3d same(const Eigen::RowVector3d& p) {
  return p;
}

// (frames, joints, 3) of a clip's joints.
inline std::vector<double> places(const Clip& clip, int joints, const Place3& change = same) {
  std::vector<double> values;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions positions = joint_positions(clip, t);
    for (int j = 0; j < joints; ++j) {
      const Eigen::RowVector3d place = change(positions.row(j));
      values.insert(values.end(), place.data(), place.data() + 3);
    }
  }
  return values;
}

inline std::string array_bytes(const Clip& clip, int joints, const Place3& change = same) {
  return npy_bytes(places(clip, joints, change).data(),
                   {static_cast<std::size_t>(clip.frames()), static_cast<std::size_t>(joints), 3});
}

inline double worst_distance(const Clip& a, const Clip& b, int joints = 22) {
  EXPECT_EQ(a.frames(), b.frames());
  double worst = 0;
  for (Eigen::Index t = 0; t < std::min(a.frames(), b.frames()); ++t) {
    const JointPositions p = joint_positions(a, t), q = joint_positions(b, t);
    for (int j = 0; j < joints; ++j) worst = std::max(worst, (p.row(j) - q.row(j)).norm());
  }
  return worst;
}

inline bool has_remark(const ReadReport& report, const std::string& kind,
                       const std::string& part = "") {
  for (const Remark& remark : report.remarks)
    if (remark.kind == kind && contains(remark.text, part)) return true;
  return false;
}

inline ReadOptions with_fps(double fps) {
  ReadOptions options;
  options.fps = fps;
  return options;
}

inline const std::vector<std::pair<int, std::string>>& open_pose_names() {
  static const std::vector<std::pair<int, std::string>> names = {
      {2, "RHip"},    {5, "RKnee"},   {8, "RAnkle"},     {11, "RBigToe"}, {1, "LHip"},
      {4, "LKnee"},   {7, "LAnkle"},  {10, "LBigToe"},   {12, "Neck"},    {17, "RShoulder"},
      {19, "RElbow"}, {21, "RWrist"}, {16, "LShoulder"}, {18, "LElbow"},  {20, "LWrist"}};
  return names;
}

inline std::string trc_of(const Clip& clip, const std::vector<std::pair<int, std::string>>& joints,
                          const std::string& unit, double scale, const std::string& rate = "60") {
  const std::string count = std::to_string(joints.size());
  std::string text =
      "PathFileType\t4\t(X/Y/Z)\twalk.trc\r\n"
      "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\r\n" +
      rate + "\t60\t" + std::to_string(clip.frames()) + "\t" + count + "\t" + unit +
      "\t60\r\nFrame#\tTime";
  for (const auto& [joint, name] : joints) text += "\t" + name + "\t\t";
  text += "\r\n\t";
  for (std::size_t i = 1; i <= joints.size(); ++i)
    for (const char* axis : {"X", "Y", "Z"}) text += "\t" + (axis + std::to_string(i));
  text += "\r\n\r\n";
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    text += std::to_string(t + 1) + "\t" + format_fixed(static_cast<double>(t) / clip.fps, 5);
    const JointPositions places = joint_positions(clip, t);
    // Z up, as cameras in a room have it.
    for (const auto& [joint, name] : joints)
      for (const double value : {places(joint, 0), -places(joint, 2), places(joint, 1)})
        text += "\t" + format_fixed(scale * value, 6);
    text += "\r\n";
  }
  return text;
}

}  // namespace mocaplm
