// From positions of joints to the rotations of the SMPL figure: inverse kinematics with bone
// lengths fitted.
//
// The figure's bones keep their lengths, so what is taken from a source of other proportions is
// where its bones point. Pelvis and chest are turned by the lines across (hips; collars or
// shoulders) and the trunk; arms, legs, spine, neck, hands and feet by their bones; upper arms and
// thighs about themselves by the plane in which elbow and knee bend (limb.h). The path of the hips
// is scaled by the ratio of the legs, so that feet planted in the source stay planted.
#pragma once

#include <string>

#include "motion/clip.h"
#include "motion/ik/body_measure.h"
#include "motion/ik/points.h"

namespace mocaplm {

// Distances between joints of the figure and where they should be, centimetres.
struct Residual {
  double root_mean_square = 0, worst = 0;
  int worst_point = 0;
  Eigen::Index worst_frame = 0;
};

struct PositionFit {
  Clip clip;                      // without a name; its rate is that of the tracks
  double scale = 1;               // figure's size over the source's
  Residual from_bones;            // against the source's bone directions at the figure's lengths
  Residual from_source;           // against the source itself, scaled
  bool pelvis_is_middle = false;  // "pelvis" is the middle of the hips, not SMPL's joint
};

// `tracks`: Y up, every given point finite in every frame, all of needed_points() among them; any
// unit, which `unit` says in metres. With `keep_path` positions of the hips are metres as given,
// unscaled. Never fails on finite input; a bone without length points as in the frame before.
PositionFit fit_positions(const PointTracks& tracks, double unit, bool keep_path);

}  // namespace mocaplm
