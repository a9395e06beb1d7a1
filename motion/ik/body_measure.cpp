#include "motion/ik/body_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr int kHip[] = {1, 2}, kKnee[] = {4, 5}, kAnkle[] = {7, 8}, kFoot[] = {10, 11},
              kShoulder[] = {16, 17}, kElbow[] = {18, 19}, kWrist[] = {20, 21};

double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::vector<double> lengths(const PointTracks& tracks, int a, int b) {
  std::vector<double> all;
  all.reserve(static_cast<std::size_t>(tracks.frames()));
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    all.push_back((tracks.at(t, a) - tracks.at(t, b)).norm());
  return all;
}

std::string times(double ratio) {
  return format_fixed(ratio, 2) + " times";
}

}  // namespace

BodyMeasure measure_body(const PointTracks& tracks) {
  BodyMeasure body;
  const auto bone = [&](int a, int b) {
    std::vector<double> all = lengths(tracks, a, b);
    const double median = quantile(all, 0.5);
    const double spread = quantile(all, 0.75) - quantile(all, 0.25);
    const double variation = median > 0 ? spread / median : HUGE_VAL;
    if (variation > body.variation || body.variation_of.empty()) {
      body.variation = variation;
      body.variation_of = point_name(a) + " to " + point_name(b);
    }
    return median;
  };
  for (int side = 0; side < 2; ++side) {
    body.thigh[side] = bone(kHip[side], kKnee[side]);
    body.shin[side] = bone(kKnee[side], kAnkle[side]);
    body.upper_arm[side] = bone(kShoulder[side], kElbow[side]);
    body.forearm[side] = bone(kElbow[side], kWrist[side]);
  }
  std::vector<double> hips = lengths(tracks, kHip[0], kHip[1]),
                      shoulders = lengths(tracks, kShoulder[0], kShoulder[1]), trunk;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    trunk.push_back(
        (tracks.middle(t, kShoulder[0], kShoulder[1]) - tracks.middle(t, kHip[0], kHip[1])).norm());
  body.hip_width = quantile(hips, 0.5);
  body.shoulder_width = quantile(shoulders, 0.5);
  body.trunk = quantile(trunk, 0.5);
  return body;
}

const BodyMeasure& smpl_measure() {
  static const BodyMeasure measure = [] {
    PointTracks rest;
    rest.places.setZero(1, 3 * kPoints);
    for (int j = 0; j < kJoints; ++j) rest.places.row(0).segment<3>(3 * j) = rest_joints().row(j);
    return measure_body(rest);
  }();
  return measure;
}

void check_body(const BodyMeasure& body, const std::string& file) {
  std::string what;
  const auto compare = [&](double a, double b, double most, const std::string& text) {
    const double ratio = a / b;
    if (what.empty() && !(ratio < most && ratio > 1 / most)) what = text + " " + times(ratio);
  };
  const auto both = [](const double(&sides)[2]) { return (sides[0] + sides[1]) / 2; };
  const double arm = both(body.upper_arm) + both(body.forearm);
  if (!(body.leg() > 0 && arm > 0)) what = "its limbs have no length";
  compare(body.thigh[0], body.thigh[1], 1.4, "the left thigh is as long as the right");
  compare(body.shin[0], body.shin[1], 1.4, "the left shin is as long as the right");
  compare(body.upper_arm[0], body.upper_arm[1], 1.4, "the left upper arm is as long as the right");
  compare(body.forearm[0], body.forearm[1], 1.4, "the left forearm is as long as the right");
  compare(both(body.thigh), both(body.shin), 2, "thighs are as long as shins");
  compare(both(body.upper_arm), both(body.forearm), 2, "upper arms are as long as forearms");
  compare(arm / body.leg(), 0.65, 2.2, "arms, by the legs, are as long as a person's");
  compare(body.trunk / body.leg(), 0.7, 2.2, "the trunk, by the legs, is as long as a person's");
  compare(body.hip_width / body.leg(), 0.18, 4, "hips, by the legs, are as wide as a person's");
  compare(body.shoulder_width / body.leg(), 0.45, 2.5,
          "shoulders, by the legs, are as wide as a person's");
  if (what.empty() && body.variation > 0.35)
    what = "the way from " + body.variation_of + " changes its length by " +
           format_fixed(100 * body.variation, 0) + " % between frames";
  if (!what.empty())
    throw DataError(in_file(file), "does not hold the joints of a person in the expected order (" +
                                       what +
                                       "): joints of another order, or numbers that are no "
                                       "positions");
}

void check_handedness(const PointTracks& tracks, const std::string& file) {
  double toes = 0, knees = 0;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) {
    const Eigen::Vector3d left = tracks.at(t, kHip[0]) - tracks.at(t, kHip[1]);
    const Eigen::Vector3d up =
        tracks.middle(t, kShoulder[0], kShoulder[1]) - tracks.middle(t, kHip[0], kHip[1]);
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d hip = tracks.at(t, kHip[side]), knee = tracks.at(t, kKnee[side]),
                            ankle = tracks.at(t, kAnkle[side]);
      const Eigen::Vector3d forward = left.cross(up).normalized();
      // The knee lies before the line from hip to ankle.
      const Eigen::Vector3d line = ankle - hip;
      Eigen::Vector3d bend = knee - hip;
      bend -= bend.dot(line) / std::max(line.squaredNorm(), 1e-300) * line;
      const double knee_share = forward.dot(bend) / std::max((knee - hip).norm(), 1e-300);
      if (std::isfinite(knee_share)) knees += knee_share;
      if (!tracks.has(kFoot[side])) continue;
      const double toe_share = forward.dot((tracks.at(t, kFoot[side]) - ankle).normalized());
      if (std::isfinite(toe_share)) toes += toe_share;
    }
  }
  const double count = 2 * static_cast<double>(tracks.frames());
  const bool has_toes = tracks.given[10] || tracks.given[11];
  if (has_toes ? toes / count < -0.35 : knees / count < -0.1)
    throw DataError(in_file(file),
                    std::string("shows a mirrored body, whose ") + (has_toes ? "toes" : "knees") +
                        " point backwards: its axes are left-handed or its left and right are "
                        "exchanged; negate one axis (x, say) of all positions");
}

FoundUp find_up(const PointTracks& tracks) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) {
    const Eigen::Vector3d hips = tracks.middle(t, kHip[0], kHip[1]);
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(tracks.middle(t, kShoulder[0], kShoulder[1]) - hips),
          Eigen::Vector3d(hips - tracks.middle(t, kAnkle[0], kAnkle[1]))})
      if (way.norm() > 0) sum += way.normalized();
  }
  sum /= 2 * static_cast<double>(tracks.frames());
  const std::pair<double, UpAxis> shares[] = {
      {sum.x(), UpAxis::x},        {sum.y(), UpAxis::y},        {sum.z(), UpAxis::z},
      {-sum.x(), UpAxis::minus_x}, {-sum.y(), UpAxis::minus_y}, {-sum.z(), UpAxis::minus_z}};
  FoundUp found;
  found.share = -2;
  for (const auto& [share, axis] : shares) {
    if (share > found.share) {
      found.second = found.share;
      found.share = share;
      found.axis = axis;
    } else {
      found.second = std::max(found.second, share);
    }
  }
  return found;
}

}  // namespace mocaplm
