#include "motion/formats/bvh_gaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/angles.h"
#include "common/random.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "support/refusal.h"

namespace mocaplm::bvh_gaps_test {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

// One joint whose axes come in `order`, positions after the rotations, and beside it a joint of one
// angle.
Bvh figure(const EulerOrder& order, Eigen::Index frames) {
  Bvh bvh;
  BvhJoint hips;
  hips.name = "Hips";
  for (const int axis : order) hips.channels.push_back(static_cast<BvhChannel>(3 + axis));
  for (int axis = 0; axis < 3; ++axis) hips.channels.push_back(static_cast<BvhChannel>(axis));
  BvhJoint knee;
  knee.name = "Knee";
  knee.parent = 0;
  knee.channels = {BvhChannel::x_rotation};
  knee.first_channel = 6;
  bvh.joints = {hips, knee};
  bvh.values.setZero(frames, 7);
  return bvh;
}

Eigen::Quaterniond rotation(const Bvh& bvh, Eigen::Index frame, const EulerOrder& order) {
  return quaternion_from_matrix(
      matrix_from_euler(kRadians * bvh.values.row(frame).head<3>().transpose(), order));
}

// A joint that turns steadily about any axis, and goes steadily: the gap is known.
TEST(BvhGaps, SteadyMotionComesBack) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<int> axes = {0, 1, 2};
    random.shuffle(axes);
    const EulerOrder order = {axes[0], axes[1], axes[2]};
    const Eigen::Index frames = 30;
    Bvh bvh = figure(order, frames);
    const Eigen::Quaterniond start = quaternion_from_axis_angle(3 * random_direction(random));
    const Eigen::Vector3d turn = 0.1 * random_direction(random), way = random_direction(random);
    std::vector<Eigen::Quaterniond> truth;
    for (Eigen::Index t = 0; t < frames; ++t) {
      const auto time = static_cast<double>(t);
      truth.push_back(start * quaternion_from_axis_angle(time * turn));
      bvh.values.row(t).head<3>() =
          (euler_from_matrix(truth.back().toRotationMatrix(), order) / kRadians).transpose();
      bvh.values.row(t).segment<3>(3) = time * way.transpose();
      bvh.values(t, 6) = std::remainder(350 + 3 * time, 360);  // over the half turn
    }
    const Bvh whole = bvh;
    const auto first = static_cast<Eigen::Index>(1 + random.below(10)),
               last = first + 1 + static_cast<Eigen::Index>(random.below(15));
    for (Eigen::Index t = first; t < last; ++t) {
      bvh.values(t, static_cast<Eigen::Index>(random.below(3))) = kNan;  // any one angle
      bvh.values(t, 3 + static_cast<Eigen::Index>(random.below(3))) = kNan;
      bvh.values(t, 6) = kNan;
    }
    fill_gaps(bvh, 30, "f");
    ASSERT_TRUE(bvh.values.allFinite());
    for (Eigen::Index t = 0; t < frames; ++t) {
      EXPECT_LT(geodesic_angle(rotation(bvh, t, order), truth[static_cast<std::size_t>(t)]), 1e-6);
      EXPECT_LT((bvh.values.row(t) - whole.values.row(t)).segment<3>(3).norm(), 1e-9);
      EXPECT_NEAR(std::remainder(bvh.values(t, 6) - whole.values(t, 6), 360), 0, 1e-9);
      if (t < first || t >= last) EXPECT_EQ(bvh.values.row(t), whole.values.row(t));
    }
  }
}

TEST(BvhGaps, AtTheEndsTheNextValueIsHeld) {
  Bvh bvh = figure({2, 0, 1}, 10);
  for (Eigen::Index t = 0; t < 10; ++t) bvh.values.row(t).setConstant(static_cast<double>(t));
  bvh.values.topRows(3).setConstant(kNan);
  bvh.values.bottomRows(2).setConstant(kNan);
  fill_gaps(bvh, 30, "f");
  for (int c = 0; c < 7; ++c) {
    EXPECT_NEAR(bvh.values(0, c), 3, 1e-9);
    EXPECT_NEAR(bvh.values(2, c), 3, 1e-9);
    EXPECT_NEAR(bvh.values(9, c), 7, 1e-9);
  }
}

TEST(BvhGaps, OverASecondIsRefusedWithItsPlace) {
  for (const double fps : {10., 30., 120.}) {
    const auto second = static_cast<Eigen::Index>(fps);
    for (const Eigen::Index length : {second, second + 1}) {
      Bvh bvh = figure({2, 0, 1}, 3 * second);
      for (Eigen::Index t = 0; t < length; ++t) bvh.values(5 + t, 6) = kNan;
      if (length == second) {
        fill_gaps(bvh, fps, "f");
        EXPECT_TRUE(bvh.values.allFinite());
      } else {
        const std::string message = refusal([&] { fill_gaps(bvh, fps, "f"); });
        EXPECT_NE(message.find("f: frame 5, joint Knee: has no number up to frame " +
                               std::to_string(4 + length)),
                  std::string::npos)
            << message;
      }
    }
  }
  Bvh never = figure({2, 0, 1}, 3);
  never.values.col(1).setConstant(kNan);
  EXPECT_NE(refusal([&] {
              fill_gaps(never, 30, "f");
            }).find("frame 0, joint Hips: has no number in any frame"),
            std::string::npos);
}

TEST(BvhGaps, WordsThatProgramsWriteForNoNumber) {
  const std::string head =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 2 Xposition Yrotation\n}\nMOTION\n"
      "Frames: 3\nFrame Time: 0.04\n0 10\n";
  BvhTextOptions fill;
  fill.fill_gaps = true;
  for (const std::string word :
       {"nan", "NaN", "-nan", "nan(ind)", "-nan(ind)", "-nan(0x8000000000000)", "inf", "-Infinity",
        "1.#IND", "-1.#IND00", "1.#QNAN", "1.#INF", "null"}) {
    EXPECT_TRUE(is_gap(word)) << word;
    const std::string text = head + word + " " + word + "\n2 20\n";
    const std::string message = refusal([&] { parse_bvh(text, "f"); });
    EXPECT_NE(
        message.find("f: line 11, frame 1, joint Hips, Xposition: found \"" + word.substr(0, 40)),
        std::string::npos)
        << message;
    EXPECT_NE(message.find("--fill-gaps"), std::string::npos) << message;
    const Bvh bvh = parse_bvh(text, "f", fill);
    EXPECT_NEAR(bvh.values(1, 0), 1, 1e-12) << word;
    EXPECT_NEAR(bvh.values(1, 1), 15, 1e-12) << word;
    ASSERT_EQ(bvh.remarks.size(), 1u);
    EXPECT_EQ(bvh.remarks[0].text,
              "2 values that are no number, the first in frame 1, joint Hips, "
              "Xposition, are interpolated");
    // The last word of the text is a gap, too.
    EXPECT_EQ(parse_bvh(head + "0 10\n0 " + word, "f", fill).values(2, 1), 10);
  }
  for (const std::string word : {"12", "x", "-", "1e300", "--", "1.5.2"})
    EXPECT_FALSE(is_gap(word)) << word;
  EXPECT_THROW(parse_bvh(head + "1e300 3\n2 20\n", "f", fill), DataError);
}

// How long a second is depends on the rate that was asked for.
TEST(BvhGaps, AGivenRateCounts) {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n}\nMOTION\n"
      "Frames: 42\nFrame Time: 0.04\n0\n";
  for (int t = 0; t < 40; ++t) text += "nan\n";
  text += "41\n";
  BvhTextOptions options;
  options.fill_gaps = true;
  EXPECT_THROW(parse_bvh(text, "f", options), DataError);
  options.fps = 50;
  EXPECT_NEAR(parse_bvh(text, "f", options).values(20, 0), 20, 1e-12);
}

}  // namespace
}  // namespace mocaplm::bvh_gaps_test
