// Against clips that an independent program converted from the same .bvh files
// (../shared/data/formats/expected.json). That program used SMPL rest joints that differ by up to a
// centimetre, so what depends on the rest pose is compared through it: wherever a limb of the
// source points, the reference's rotation must bring one and the same rest direction there, in all
// frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "common/json.h"
#include "common/temporary_folder.h"
#include "motion/formats/retarget.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::retarget_reference_test {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

// bandai-2 is as bandai-1 and takes longest to unpack: retarget_slow_test has it.
constexpr const char* kArchives[] = {"cmu-dance", "bandai-1"};
const std::string kData = std::string(MOCAPLM_SOURCE_DIR) + "/../shared/data";

struct Sample {
  std::string source;
  Eigen::Index frame;
  Clip reference;  // one frame; trans holds the pelvis joint itself
};

std::vector<Sample> samples() {
  std::vector<Sample> all;
  const Json expected = load_json(kData + "/formats/expected.json");
  for (const auto& [name, entry] : expected["files"].items()) {
    if (entry["format"] != "amass-npz" || name.compare(0, 7, "variant") == 0) continue;
    const std::string source = entry["source"];
    if (source.compare(0, 8, "bandai-2") == 0) continue;
    for (const int last : {0, 1}) {
      Sample sample{source, entry["source_frames"][static_cast<std::size_t>(last)], {}};
      sample.reference.poses.resize(1, 72);
      sample.reference.trans.resize(1, 3);
      const Json& poses = entry[last ? "poses_last" : "poses_first"];
      for (std::size_t c = 0; c < 72; ++c)
        sample.reference.poses(0, static_cast<int>(c)) = poses[c];
      const Json& trans = entry[last ? "trans_m_last" : "trans_m_first"];
      for (std::size_t c = 0; c < 3; ++c) sample.reference.trans(0, static_cast<int>(c)) = trans[c];
      all.push_back(sample);
    }
  }
  return all;
}

class RetargetReference : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kData + "/formats/expected.json"))
      GTEST_SKIP() << "no " << kData << "/formats/expected.json";
    samples_ = samples();
    for (const char* archive : kArchives) {
      std::string members;
      for (const Sample& sample : samples_)
        if (sample.source.find(archive) == 0 && members.find(sample.source) == members.npos)
          members += " " + sample.source;
      const std::string command = "tar -xf '" + kData + "/" + archive + "-bvh.tar.xz' -C '" +
                                  directory_.path().string() + "'" + members + " 2> /dev/null";
      if (std::system(command.c_str()) != 0)
        GTEST_SKIP() << "cannot unpack " << archive << " (needs tar and xz)";
    }
  }

  TemporaryFolder directory_;
  std::vector<Sample> samples_;
};

Vector3d vector(const Clip& clip, Eigen::Index frame, int joint) {
  return clip.poses.row(frame).segment<3>(3 * joint).transpose();
}

// How far values that should be one and the same are from their mean.
double spread(const std::vector<Vector3d>& values) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& v : values) mean += v / static_cast<double>(values.size());
  double worst = 0;
  for (const Vector3d& v : values) worst = std::max(worst, (v - mean).norm());
  return worst;
}

TEST_F(RetargetReference, Agrees) {
  constexpr int kBones[][2] = {{1, 4},   {4, 7},   {2, 5},   {5, 8},   {16, 18},
                               {18, 20}, {17, 19}, {19, 21}, {20, 22}, {21, 23}};
  std::map<int, std::vector<Vector3d>> rest;  // by joint: the reference's rest bone directions
  std::vector<Vector3d> hips;                 // from its pelvis to the middle of its hips
  std::vector<double> untwisted;
  for (const Sample& sample : samples_) {
    const Bvh bvh = read_bvh(directory_ / sample.source);
    BvhOptions options;
    options.keep_path = true;  // the reference does not scale it
    const Clip clip = retarget_bvh(bvh, sample.source, options);
    RetargetMap plain = detect_map(bvh, sample.source);
    plain.align = false;
    const Clip raw = retarget_bvh(bvh, plain, sample.source, options, nullptr);
    const auto ours = joint_world_rotations(clip, sample.frame),
               theirs = joint_world_rotations(sample.reference, 0);
    const auto base = joint_world_rotations(raw, sample.frame);
    // What no rest pose has a part in is equal, number for number, but for the pelvis' sign near
    // pi.
    for (const int j : {0, 3, 6, 9, 10, 11, 12, 13, 14, 15, 22, 23})
      EXPECT_LT(geodesic_angle(quaternion_from_axis_angle(vector(clip, sample.frame, j)),
                               quaternion_from_axis_angle(vector(sample.reference, 0, j))),
                1e-7)
          << sample.source << " " << joint_names()[static_cast<std::size_t>(j)];
    for (const int j : {7, 8})
      EXPECT_LT((ours[static_cast<std::size_t>(j)] - theirs[static_cast<std::size_t>(j)]).norm(),
                1e-7);
    const JointPositions positions = joint_positions(clip, sample.frame);
    for (const auto& bone : kBones) {
      const auto j = static_cast<std::size_t>(bone[0]);
      const Vector3d direction =
          (positions.row(bone[1]) - positions.row(bone[0])).transpose().normalized();
      const Vector3d theirs_at_rest = theirs[j].transpose() * direction;
      rest[bone[0]].push_back(theirs_at_rest);
      // No twist beyond the smallest rotation from the rest direction, as ours.
      const Eigen::Matrix3d expected =
          shortest_rotation(base[j] * theirs_at_rest, direction).toRotationMatrix() * base[j];
      untwisted.push_back((expected - theirs[j]).norm());
    }
    const Vector3d middle = 0.5 * (positions.row(1) + positions.row(2)).transpose();
    hips.push_back(theirs[0].transpose() * (middle - sample.reference.trans.row(0).transpose()));
  }
  ASSERT_EQ(rest.size(), 10u);
  for (const auto& [joint, directions] : rest)
    EXPECT_LT(spread(directions), 1e-6) << joint_names()[static_cast<std::size_t>(joint)];
  EXPECT_LT(spread(hips), 1e-6);
  EXPECT_LT(*std::max_element(untwisted.begin(), untwisted.end()), 1e-6);
}

}  // namespace
}  // namespace mocaplm::retarget_reference_test
