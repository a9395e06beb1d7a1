#include "viewer/figure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/floor.h"

namespace mocaplm {

namespace {

// A point fixed to a joint: its offset in the rest pose, metres.
struct SurfacePoint {
  int joint;
  Eigen::RowVector3d offset;
};

SurfacePoint at_sole(std::size_t sole) {
  return {figure_soles()[sole].joint, figure_soles()[sole].middle};
}

const std::array<SurfacePoint, kFigurePoints - kJoints>& surface_points() {
  static const std::array<SurfacePoint, kFigurePoints - kJoints> points = {{
      {15, {0, 0.20, 0}},     // crown
      {15, {0, 0.08, 0.12}},  // face
      at_sole(0),             // left heel
      at_sole(1),             // right heel
      at_sole(4),             // left toe tip
      at_sole(5),             // right toe tip
  }};
  return points;
}

// Which points are the middles of figure_soles().
constexpr std::array<int, 6> kSolePoints = {26, 27, 10, 11, 28, 29};

double lowest_sole(const JointPositions& points) {
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kSolePoints.size(); ++i)
    lowest = std::min(lowest, points(kSolePoints[i], 1) - figure_soles()[i].radius);
  return lowest;
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
    soles.push_back(lowest_sole(points));
  }
  figure.shift = -(low + high) / 2;
  figure.shift.y() = -ground_below(std::move(soles));
  all.rowwise() += figure.shift;

  figure.unit = std::max(figure.unit, all.cwiseAbs().maxCoeff() / 32767);
  figure.points.resize(static_cast<std::size_t>(all.size()));
  std::transform(all.data(), all.data() + all.size(), figure.points.begin(),
                 [&](double x) { return static_cast<std::int16_t>(std::lround(x / figure.unit)); });
  return figure;
}

}  // namespace mocaplm
