// What the page draws of a clip: the joints and a few points of the body's surface, frame by frame,
// placed on the ground and quantised.
#pragma once

#include <cstdint>
#include <vector>

#include "motion/skeleton.h"

namespace mocaplm {

// SMPL's 24 joints, then: crown, face, left heel, right heel, left toe tip, right toe tip. These
// turn with the head, ankles and feet and give the figure a face and soles (assets/body.js draws
// them).
constexpr int kFigurePoints = kJoints + 6;

// Faster clips are thinned to every n-th frame (never interpolated), so that the page shows real
// frames.
constexpr double kFigureMaxFps = 60;

struct Figure {
  double fps = 0;  // of the frames below: the clip's own, divided by a whole number
  std::int64_t frames = 0;
  std::int64_t every = 1;  // frame f here is frame f * every of the clip
  double unit = 0.0005;    // metres a step; larger only for paths beyond +-16 m
  Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();  // added to the clip's positions, metres
  std::vector<std::int16_t> points;                       // (frames, kFigurePoints, 3) in units
};

// One frame of a clip, (kFigurePoints, 3) world metres.
JointPositions figure_points(const Clip& clip, Eigen::Index frame);

// The shift puts the lowest sole of all frames on y = 0 (ground_below in motion/floor.h: frames
// that are taken for faults may sink in) and the middle of the pelvis' path (of its bounding box)
// on x = z = 0. Throws DataError when the clip is not valid (check_clip).
Figure make_figure(const Clip& clip);

}  // namespace mocaplm
