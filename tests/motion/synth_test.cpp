#include "motion/synth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/error.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/synth/beat.h"

namespace mocaplm::synth_test {
namespace {

// Every third dance of the default set: all genres, dancers and situations, in a second or two.
const std::vector<std::pair<Dance, Clip>>& dances() {
  static const auto all = [] {
    const SynthConfig config;
    std::vector<std::pair<Dance, Clip>> made;
    const std::vector<Dance> plan = plan_dances(config);
    for (std::size_t i = 0; i < plan.size(); i += 3)
      made.emplace_back(plan[i], make_dance(plan[i], config));
    return made;
  }();
  return all;
}

std::vector<JointPositions> joints_of(const Clip& clip) {
  std::vector<JointPositions> all;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) all.push_back(joint_positions(clip, t));
  return all;
}

TEST(Synth, FeetNeitherSkateNorSinkNorFly) {
  std::size_t low = 0, skating = 0, frames = 0, off_floor = 0;
  double lowest = 1, highest_low = -1;
  for (const auto& [dance, clip] : dances()) {
    const auto joints = joints_of(clip);
    for (std::size_t t = 0; t < joints.size(); ++t) {
      const double toes = std::min(joints[t](10, 1), joints[t](11, 1));
      lowest = std::min(lowest, toes);
      highest_low = std::max(highest_low, toes);
      if (toes > 0.03) ++off_floor;
      if (t == 0) continue;
      ++frames;
      bool skates = false;
      for (int toe : {10, 11}) {
        if (joints[t](toe, 1) >= 0.05) continue;
        ++low;
        const double dx = joints[t](toe, 0) - joints[t - 1](toe, 0);
        const double dz = joints[t](toe, 2) - joints[t - 1](toe, 2);
        skates = skates || std::hypot(dx, dz) * clip.fps > 0.5;
      }
      if (skates) ++skating;
    }
  }
  RecordProperty("skating_percent", std::to_string(100.0 * skating / frames));
  std::printf(
      "skating %.3f %% of frames, lowest toe %.4f m, both toes up %.2f %%, at most %.3f m\n",
      100.0 * skating / frames, lowest, 100.0 * off_floor / frames, highest_low);
  EXPECT_LT(skating, 0.05 * frames);
  EXPECT_GT(low, frames / 2);
  EXPECT_GT(lowest, 0.0);
  EXPECT_LT(off_floor, 0.02 * frames);
}

TEST(Synth, MovesAsSmoothlyAsABody) {
  double fastest = 0, jump = 0, root_speed = 0;
  std::string where, where_jump;
  for (const auto& [dance, clip] : dances()) {
    Eigen::VectorXd before(24);
    before.setZero();
    for (Eigen::Index t = 1; t < clip.frames(); ++t) {
      root_speed =
          std::max(root_speed, (clip.trans.row(t) - clip.trans.row(t - 1)).norm() * clip.fps);
      for (int j = 0; j < 24; ++j) {
        const double speed =
            clip.fps *
            geodesic_angle(
                quaternion_from_axis_angle(clip.poses.block<1, 3>(t, 3 * j).transpose()),
                quaternion_from_axis_angle(clip.poses.block<1, 3>(t - 1, 3 * j).transpose()));
        if (speed > fastest) where = clip.name + " " + joint_names()[static_cast<std::size_t>(j)];
        fastest = std::max(fastest, speed);
        if (t > 1) {
          const double change = std::abs(speed - before(j));
          if (change > jump)
            where_jump = clip.name + " " + joint_names()[static_cast<std::size_t>(j)] + " " +
                         std::to_string(t);
          jump = std::max(jump, change);
        }
        before(j) = speed;
      }
    }
  }
  std::printf(
      "fastest joint %.1f rad/s (%s), change of speed from frame to frame %.1f rad/s (%s), root "
      "%.2f m/s\n",
      fastest, where.c_str(), jump, where_jump.c_str(), root_speed);
  EXPECT_LT(fastest, 25);
  EXPECT_LT(jump, 12);
  EXPECT_LT(root_speed, 3);
}

// Autocorrelation of a signal at a lag in frames, 1 for a signal of that period.
double correlation(const Eigen::VectorXd& x, Eigen::Index lag) {
  const Eigen::Index n = x.size() - lag;
  const Eigen::VectorXd a = x.head(n).array() - x.head(n).mean();
  const Eigen::VectorXd b = x.tail(n).array() - x.tail(n).mean();
  return a.dot(b) / std::max(1e-12, a.norm() * b.norm());
}

TEST(Synth, DancesToTheBeat) {
  double on = 0, off = 0;
  int clips = 0;
  for (const auto& [dance, clip] : dances()) {
    if (dance.situation != Situation::basic) continue;
    const double beat = music_of(dance.genre_code, dance.music).beat_seconds() * clip.fps;
    // The basic phrase is A B A B in moves of four beats.
    const Eigen::VectorXd arm =
        clip.poses.col(3 * 18 + 1)
            .head(std::min<Eigen::Index>(clip.frames(), std::lround(16 * beat)));
    on += correlation(arm, std::lround(8 * beat));
    off += correlation(arm, std::lround(7 * beat));
    ++clips;
  }
  std::printf("the phrase comes back after 8 beats with correlation %.3f, after 7 with %.3f\n",
              on / clips, off / clips);
  EXPECT_GT(on / clips, 0.7);
  EXPECT_LT(off / clips, 0.5);
}

TEST(Synth, NamesLabelsAndSplitsFollowThePlan) {
  const std::vector<Dance> plan = plan_dances(SynthConfig{});
  EXPECT_EQ(plan.size(), 240u);
  std::map<std::string, std::set<std::string>> splits;  // of each dancer
  std::set<std::string> names;
  for (const Dance& dance : plan) {
    EXPECT_TRUE(names.insert(dance.name).second) << dance.name;
    splits[dance.name.substr(0, 3) + dance.name.substr(9, 8)].insert(dance.split);
  }
  EXPECT_EQ(splits.size(), 30u);
  for (const auto& [dancer, in] : splits) EXPECT_EQ(in.size(), 3u) << dancer;
  for (const auto& [dance, clip] : dances()) {
    EXPECT_EQ(clip.labels.size(), 5u);
    EXPECT_EQ(clip.labels.at("situation"),
              dance.situation == Situation::basic ? "basic" : "advanced");
    EXPECT_EQ(clip.fps, 60);
    EXPECT_EQ(clip.frames(), 600);
  }
}

TEST(Synth, TheSameSeedGivesBitwiseTheSameAndAnotherDoesNot) {
  SynthConfig config;
  const Dance dance = plan_dances(config)[100];
  const Clip once = make_dance(dance, config), again = make_dance(dance, config);
  EXPECT_TRUE((once.poses.array() == again.poses.array()).all());
  EXPECT_TRUE((once.trans.array() == again.trans.array()).all());
  config.seed = 2;
  const Clip other = make_dance(dance, config);
  EXPECT_GT((once.poses - other.poses).cwiseAbs().maxCoeff(), 0.05);
}

TEST(Synth, FewerGenresShorterClipsOtherRates) {
  SynthConfig config;
  config.genres = {"KR", "WA", "KR"};
  config.dancers = 2;
  config.choreographies = 1;
  config.seconds = 1;
  config.fps = 24;
  const std::vector<Dance> plan = plan_dances(config);
  EXPECT_EQ(plan.size(), 8u);
  for (const Dance& dance : plan) {
    EXPECT_EQ(make_dance(dance, config).frames(), 24);
    EXPECT_EQ(dance.split, "train");
  }
  config.genres = {"WAACK"};
  EXPECT_THROW(plan_dances(config), UsageError);
}

}  // namespace
}  // namespace mocaplm::synth_test
