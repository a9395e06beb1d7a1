#include "evaluate/generated/motion_measures.h"

#include <algorithm>
#include <cmath>

#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr int kToes[] = {10, 11};

std::vector<JointPositions> all_positions(const Clip& clip) {
  std::vector<JointPositions> positions;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) positions.push_back(joint_positions(clip, t));
  return positions;
}

double horizontal(const Eigen::RowVector3d& v) {
  return std::hypot(v.x(), v.z());
}

void measure_root(const std::vector<JointPositions>& p, double fps, MotionMeasures& measures) {
  const auto two_seconds = static_cast<std::size_t>(std::llround(2 * fps));
  double farthest = 0;
  for (std::size_t t = 0; t < p.size(); ++t) {
    const Eigen::RowVector3d root = p[t].row(0);
    measures.height.add(root.y());
    measures.lowest = std::min(measures.lowest, root.y());
    measures.highest = std::max(measures.highest, root.y());
    farthest = std::max(farthest, horizontal(root - p[0].row(0)));
    if (t > 0) measures.root_speed.add(horizontal(root - p[t - 1].row(0)) * fps);
    if (t >= two_seconds) measures.root_2s.add(horizontal(root - p[t - two_seconds].row(0)));
  }
  measures.root_farthest.add(farthest);
  measures.root_end.add(horizontal(p.back().row(0) - p[0].row(0)));
}

void measure_joints(const std::vector<JointPositions>& p, double fps,
                    const std::vector<int>& joints, MotionMeasures& measures) {
  for (std::size_t t = 1; t < p.size(); ++t)
    for (const int j : joints) {
      const auto at = [&](std::size_t back) { return p[t - back].row(j); };
      const auto from_root = [&](std::size_t back) {
        return (p[t - back].row(j) - p[t - back].row(0)).eval();
      };
      measures.joint_speed.add((from_root(0) - from_root(1)).norm() * fps);
      if (t >= 2) measures.acceleration.add((at(0) - 2 * at(1) + at(2)).norm() * fps * fps);
      if (t >= 3)
        measures.jerk.add((at(0) - 3 * at(1) + 3 * at(2) - at(3)).norm() * fps * fps * fps);
    }
}

void measure_feet(const std::vector<JointPositions>& p, double fps, double floor,
                  MotionMeasures& measures) {
  for (std::size_t t = 1; t < p.size(); ++t) {
    bool skates = false;
    for (const int toe : kToes) {
      const bool contact = std::max(p[t](toe, 1), p[t - 1](toe, 1)) < floor + kContactHeight;
      measures.contact.add(contact ? 1 : 0);
      if (!contact) continue;
      const double speed = horizontal(p[t].row(toe) - p[t - 1].row(toe)) * fps;
      measures.contact_speed.add(speed);
      skates = skates || speed > kSkating;
    }
    measures.skating.add(skates ? 1 : 0);
  }
}

}  // namespace

void MotionMeasures::add(const MotionMeasures& other) {
  for (Average MotionMeasures::*average :
       {&MotionMeasures::root_speed, &MotionMeasures::root_2s, &MotionMeasures::root_end,
        &MotionMeasures::root_farthest, &MotionMeasures::height, &MotionMeasures::joint_speed,
        &MotionMeasures::acceleration, &MotionMeasures::jerk, &MotionMeasures::contact,
        &MotionMeasures::contact_speed, &MotionMeasures::skating, &MotionMeasures::frozen})
    (this->*average).add(other.*average);
  lowest = std::min(lowest, other.lowest);
  highest = std::max(highest, other.highest);
}

double toe_level(const Clip& clip) {
  std::vector<double> lower;
  for (const JointPositions& p : all_positions(clip))
    lower.push_back(std::min(p(kToes[0], 1), p(kToes[1], 1)));
  if (lower.empty()) return 0;
  const auto middle = lower.begin() + static_cast<std::ptrdiff_t>(lower.size() / 2);
  std::nth_element(lower.begin(), middle, lower.end());
  return *middle;
}

MotionMeasures measure_motion(const Clip& clip, const std::vector<int>& joints, double floor) {
  MotionMeasures measures;
  const std::vector<JointPositions> positions = all_positions(clip);
  if (positions.empty()) return measures;
  measure_root(positions, clip.fps, measures);
  measure_joints(positions, clip.fps, joints, measures);
  measure_feet(positions, clip.fps, floor, measures);
  return measures;
}

}  // namespace mocaplm
