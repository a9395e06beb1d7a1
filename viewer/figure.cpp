#include "viewer/figure.h"

#include <algorithm>
#include <cmath>

namespace mocaplm {

namespace {

// A point fixed to a joint: its offset in the rest pose, metres, and the radius of the body around
// it.
struct SurfacePoint {
  int joint;
  Eigen::RowVector3d offset;
};

const std::array<SurfacePoint, kFigurePoints - kJoints>& surface_points() {
  static const std::array<SurfacePoint, kFigurePoints - kJoints> points = {{
      {15, {0, 0.20, 0}},            // crown
      {15, {0, 0.08, 0.12}},         // face
      {7, {-0.008, -0.058, -0.04}},  // left heel
      {8, {0.008, -0.050, -0.04}},   // right heel
      {10, {0.015, -0.010, 0.07}},   // left toe tip
      {11, {-0.015, -0.010, 0.07}},  // right toe tip
  }};
  return points;
}

// Heels, balls and toe tips with the radius of the figure's foot there (the same as in body.js):
// the soles of the rest pose are level within 2 mm.
struct Sole {
  int point;
  double radius;
};
constexpr Sole kSoles[] = {{26, 0.032}, {27, 0.032}, {10, 0.034},
                           {11, 0.034}, {28, 0.024}, {29, 0.024}};

constexpr double kFault = 0.03;  // metres

// The lowest sole; but a few frames with faults (a foot turned over, a start in another place) do
// not lift all the others off the ground.
double ground_height(std::vector<double> soles) {
  std::sort(soles.begin(), soles.end());
  const double usual = soles[soles.size() / 20];
  return usual - soles.front() > kFault ? usual : soles.front();
}

}  // namespace

JointPositions figure_points(const Clip& clip, Eigen::Index frame) {
  JointPositions points(kFigurePoints, 3);
  points.topRows(kJoints) = joint_positions(clip, frame);
  const auto rotations = joint_world_rotations(clip, frame);
  for (int i = kJoints; i < kFigurePoints; ++i) {
    const SurfacePoint& surface = surface_points()[static_cast<std::size_t>(i - kJoints)];
    const Eigen::Matrix3d& rotation = rotations[static_cast<std::size_t>(surface.joint)];
    points.row(i) = points.row(surface.joint) + surface.offset * rotation.transpose();
  }
  return points;
}

Figure make_figure(const Clip& clip) {
  check_clip(clip, clip.name);
  Figure figure;
  // The margin keeps 60.00002 fps, as some recordings have it, whole.
  figure.every =
      std::max<std::int64_t>(1, std::llround(std::ceil(clip.fps / kFigureMaxFps - 0.01)));
  figure.fps = clip.fps / static_cast<double>(figure.every);
  figure.frames = (clip.frames() - 1) / figure.every + 1;

  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> all(figure.frames * kFigurePoints, 3);
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(1e9), high = -low;
  std::vector<double> soles;  // the lowest of each frame
  for (Eigen::Index f = 0; f < figure.frames; ++f) {
    const JointPositions points = figure_points(clip, f * figure.every);
    all.middleRows(f * kFigurePoints, kFigurePoints) = points;
    low = low.cwiseMin(points.row(0));
    high = high.cwiseMax(points.row(0));
    double sole = points(kSoles[0].point, 1);
    for (const Sole& s : kSoles) sole = std::min(sole, points(s.point, 1) - s.radius);
    soles.push_back(sole);
  }
  figure.shift = -(low + high) / 2;
  figure.shift.y() = -ground_height(std::move(soles));
  all.rowwise() += figure.shift;

  figure.unit = std::max(figure.unit, all.cwiseAbs().maxCoeff() / 32767);
  figure.points.resize(static_cast<std::size_t>(all.size()));
  std::transform(all.data(), all.data() + all.size(), figure.points.begin(),
                 [&](double x) { return static_cast<std::int16_t>(std::lround(x / figure.unit)); });
  return figure;
}

}  // namespace mocaplm
