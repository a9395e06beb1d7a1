#include "motion/ik/trunk.h"

#include <algorithm>
#include <cmath>

#include "motion/ik/body_measure.h"
#include "motion/ik/limb.h"
#include "motion/rotation.h"
#include "motion/smpl_joints.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d rest_middle(int a, int b) {
  return (rest_joint(a) + rest_joint(b)) / 2;
}

double median_of(const PointTracks& tracks, double (*value)(const PointTracks&, Eigen::Index)) {
  std::vector<double> all;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) all.push_back(value(tracks, t));
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

double ratio(double part, double of) {
  return of > 0 ? part / of : 0;
}

// A rotation from the line across the body, kept exactly, and the way up; where these are parallel
// or have no length, from the line alone and the frame before.
Quaterniond turned_by(const Vector3d& rest_across, const Vector3d& rest_up, const Vector3d& across,
                      const Vector3d& up, const Quaterniond& otherwise) {
  const double width = across.norm(), height = up.norm();
  if (!(width > 0)) return otherwise;
  if (!(across.cross(up).norm() > 1e-3 * width * height))
    return shortest_rotation(otherwise * rest_across, across) * otherwise;
  return frame_rotation(rest_across, rest_up, across, up);
}

// `rotation` turned the shortest way so that the rest pose's bone points along `to`; itself
// where that has no length.
Quaterniond aimed_if_given(const Quaterniond& rotation, const Vector3d& rest, const Vector3d& to) {
  return to.squaredNorm() > 0 ? Quaterniond(shortest_rotation(rotation * rest, to) * rotation)
                              : rotation;
}

Quaterniond pelvis_rotation(const PointTracks& tracks, const TrunkPoints& points, Eigen::Index t,
                            const Vector3d& trunk, const Quaterniond& before) {
  const Vector3d hips = tracks.middle(t, kLeftHip, kRightHip),
                 rest_hips = rest_middle(kLeftHip, kRightHip);
  const Vector3d up = points.spine    ? Vector3d(tracks.at(t, kSpine1) - hips)
                      : points.pelvis ? Vector3d(tracks.at(t, kPelvis) - hips)
                                      : trunk;
  const Vector3d rest_up = points.spine ? Vector3d(rest_joint(kSpine1) - rest_hips)
                           : points.pelvis
                               ? Vector3d(rest_joint(kPelvis) - rest_hips)
                               : Vector3d(rest_middle(kLeftShoulder, kRightShoulder) - rest_hips);
  return turned_by(rest_bone(kRightHip, kLeftHip), rest_up,
                   tracks.at(t, kLeftHip) - tracks.at(t, kRightHip), up, before);
}

Quaterniond chest_rotation(const PointTracks& tracks, const TrunkPoints& points, Eigen::Index t,
                           const Vector3d& trunk, const Quaterniond& before) {
  const int left = points.collars ? kLeftCollar : kLeftShoulder;
  const int right = points.collars ? kRightCollar : kRightShoulder;
  Vector3d up = trunk,
           rest_up = rest_middle(kLeftShoulder, kRightShoulder) - rest_middle(kLeftHip, kRightHip);
  if (points.neck && points.collars) {
    up = tracks.at(t, kNeck) - tracks.middle(t, left, right);
    rest_up = rest_joint(kNeck) - rest_middle(left, right);
  } else if (points.neck && points.spine) {
    up = tracks.at(t, kNeck) - tracks.at(t, kSpine3);
    rest_up = rest_bone(kSpine3, kNeck);
  }
  return turned_by(rest_bone(right, left), rest_up, tracks.at(t, left) - tracks.at(t, right), up,
                   before);
}

// Turns the two lower spine joints so that the line from the middle of the hips to that of the
// shoulders points as the source's does.
void keep_trunk_direction(const Vector3d& trunk, WorldRotations& world) {
  if (!(trunk.squaredNorm() > 0)) return;
  const Vector3d low = rest_joint(kSpine1) - rest_middle(kLeftHip, kRightHip);
  const Vector3d high = rest_middle(kLeftCollar, kRightCollar) - rest_joint(kSpine3);
  const Vector3d left = rest_bone(kLeftCollar, kLeftShoulder) / 2,
                 right = rest_bone(kRightCollar, kRightShoulder) / 2;
  for (int i = 0; i < 30; ++i) {
    const Vector3d line = world[kPelvis] * low + world[kSpine1] * rest_bone(kSpine1, kSpine2) +
                          world[kSpine2] * rest_bone(kSpine2, kSpine3) + world[kSpine3] * high +
                          world[kLeftCollar] * left + world[kRightCollar] * right;
    const Quaterniond turn = shortest_rotation(line, trunk);
    if (turn.vec().norm() < 1e-7) return;
    world[kSpine1] = (turn * world[kSpine1]).normalized();
    world[kSpine2] = (turn * world[kSpine2]).normalized();
  }
}

// Collars that the source does not give, aimed so that the shoulders come as high and as far apart
// as the source's, measured by what is usual for it: raised arms raise the shoulders.
void lift_shoulders(const Vector3d& trunk, const Vector3d& across, const TrunkPoints& points,
                    WorldRotations& world) {
  const Vector3d spine = world[kPelvis] * (rest_joint(kSpine1) - rest_middle(kLeftHip, kRightHip)) +
                         world[kSpine1] * rest_bone(kSpine1, kSpine2) +
                         world[kSpine2] * rest_bone(kSpine2, kSpine3);
  for (const int collar : {kLeftCollar, kRightCollar}) {
    const int shoulder = collar + kLeftShoulder - kLeftCollar;
    const double side = collar == kLeftCollar ? 0.5 : -0.5;
    const Vector3d place = spine + world[kSpine3] * rest_bone(kSpine3, collar);
    const Vector3d wanted =
        points.trunk_scale * trunk + side * points.shoulder_scale * across - place;
    const Vector3d bone = rest_bone(collar, shoulder);
    // A target at the collar itself has no direction to speak of.
    if (wanted.norm() < bone.norm() / 2) continue;
    Quaterniond& rotation = world[static_cast<std::size_t>(collar)];
    rotation = aimed_if_given(rotation, bone, wanted);
  }
}

void pose_head(const PointTracks& tracks, const TrunkPoints& points, Eigen::Index t,
               WorldRotations& world) {
  const Quaterniond chest = world[kSpine3];
  world[kNeck] = chest;
  if (points.neck && points.head)
    world[kNeck] =
        aimed_if_given(chest, rest_bone(kNeck, kHead), tracks.at(t, kHead) - tracks.at(t, kNeck));
  world[kHead] = world[kNeck];
  // Rough places on SMPL's head, seen from between the shoulders: their directions are all that
  // counts.
  const Vector3d top(0, 0.33, 0.05), nose(0, 0.20, 0.14);
  const Vector3d shoulders = tracks.middle(t, kLeftShoulder, kRightShoulder);
  const bool ears = tracks.has(kLeftEar) && tracks.has(kRightEar);
  const bool has_nose = tracks.has(kNose), has_top = tracks.has(kHeadTop);
  if (ears && (has_nose || has_top)) {
    const Vector3d middle = tracks.middle(t, kLeftEar, kRightEar);
    const Vector3d second = tracks.at(t, has_nose ? kNose : kHeadTop) - middle;
    world[kHead] = turned_by(Vector3d::UnitX(), has_nose ? Vector3d::UnitZ() : Vector3d::UnitY(),
                             tracks.at(t, kLeftEar) - tracks.at(t, kRightEar), second, chest);
  } else if (has_nose && has_top) {
    world[kHead] =
        turned_by(Vector3d::UnitY(), Vector3d::UnitZ(), tracks.at(t, kHeadTop) - shoulders,
                  tracks.at(t, kNose) - tracks.at(t, kHeadTop), chest);
  } else if (has_nose || has_top) {
    world[kHead] = aimed_if_given(chest, has_top ? top : nose,
                                  tracks.at(t, has_top ? kHeadTop : kNose) - shoulders);
  } else {
    return;
  }
  if (!(points.neck && points.head)) world[kNeck] = chest.slerp(0.5, world[kHead]);
}

}  // namespace

TrunkPoints trunk_points(const PointTracks& tracks) {
  TrunkPoints points;
  const auto hip_width = [](const PointTracks& p, Eigen::Index t) {
    return (p.at(t, kLeftHip) - p.at(t, kRightHip)).norm();
  };
  // SMPL's pelvis lies 0.66 hip widths over the middle of the hips, its collars are 0.46 of the
  // shoulders apart and its neck 0.6 collar widths above them.
  if (tracks.has(kPelvis)) {
    const auto above = [](const PointTracks& p, Eigen::Index t) {
      return (p.at(t, kPelvis) - p.middle(t, kLeftHip, kRightHip)).norm();
    };
    points.pelvis_is_middle = ratio(median_of(tracks, above), median_of(tracks, hip_width)) < 0.25;
    points.pelvis = !points.pelvis_is_middle;
  }
  points.spine = tracks.has(kSpine1) && tracks.has(kSpine2) && tracks.has(kSpine3);
  points.collars = tracks.has(kLeftCollar) && tracks.has(kRightCollar);
  points.neck = tracks.has(kNeck);
  if (points.collars) {
    const auto collars = [](const PointTracks& p, Eigen::Index t) {
      return (p.at(t, kLeftCollar) - p.at(t, kRightCollar)).norm();
    };
    const auto shoulders = [](const PointTracks& p, Eigen::Index t) {
      return (p.at(t, kLeftShoulder) - p.at(t, kRightShoulder)).norm();
    };
    points.collars = ratio(median_of(tracks, collars), median_of(tracks, shoulders)) > 0.2;
  }
  if (points.neck) {
    // Between the shoulders or the collars it says nothing about the chest.
    const auto height = [](const PointTracks& p, Eigen::Index t) {
      const bool has_collars = p.has(kLeftCollar) && p.has(kRightCollar);
      const int left = has_collars ? kLeftCollar : kLeftShoulder;
      return ratio((p.at(t, kNeck) - p.middle(t, left, left + 1)).norm(),
                   (p.at(t, kLeftShoulder) - p.at(t, kRightShoulder)).norm());
    };
    points.neck = median_of(tracks, height) > 0.1;
  }
  points.head = tracks.has(kHead);
  const BodyMeasure source = measure_body(tracks);
  // Bodies of about SMPL's proportions are scaled as a whole: medians hold what was danced, too.
  const double scale = ratio(smpl_measure().leg(), source.leg());
  const auto own = [&](double figure, double length) {
    const double found = ratio(figure, length);
    return std::abs(found - scale) < 0.08 * scale ? scale : found;
  };
  points.trunk_scale = own(smpl_measure().trunk, source.trunk);
  points.shoulder_scale = own(smpl_measure().shoulder_width, source.shoulder_width);
  return points;
}

Vector3d direction(const PointTracks& tracks, Eigen::Index frame, int a, int b,
                   const Vector3d& fallback) {
  const Vector3d way = tracks.at(frame, b) - tracks.at(frame, a);
  const double length = way.norm();
  return length > 0 ? Vector3d(way / length) : fallback;
}

void pose_trunk(const PointTracks& tracks, const TrunkPoints& points, Eigen::Index frame,
                const WorldRotations* before, WorldRotations& world) {
  const auto last = [&](int joint) {
    return before != nullptr ? (*before)[static_cast<std::size_t>(joint)] : Quaterniond::Identity();
  };
  const Vector3d trunk = tracks.middle(frame, kLeftShoulder, kRightShoulder) -
                         tracks.middle(frame, kLeftHip, kRightHip);
  world[kPelvis] = pelvis_rotation(tracks, points, frame, trunk, last(kPelvis));
  world[kSpine3] = chest_rotation(tracks, points, frame, trunk, last(kSpine3));
  world[kSpine1] = world[kPelvis].slerp(1.0 / 3, world[kSpine3]);
  world[kSpine2] = world[kPelvis].slerp(2.0 / 3, world[kSpine3]);
  if (points.spine) {
    for (const auto& [joint, child] : {std::pair{kSpine1, kSpine2}, std::pair{kSpine2, kSpine3}}) {
      Quaterniond& rotation = world[static_cast<std::size_t>(joint)];
      rotation = aimed_if_given(rotation, rest_bone(joint, child),
                                tracks.at(frame, child) - tracks.at(frame, joint));
    }
  }
  world[kLeftCollar] = world[kRightCollar] = world[kSpine3];
  if (points.collars) {
    for (const int collar : {kLeftCollar, kRightCollar}) {
      const int shoulder = collar + kLeftShoulder - kLeftCollar;
      Quaterniond& rotation = world[static_cast<std::size_t>(collar)];
      rotation = aimed_if_given(rotation, rest_bone(collar, shoulder),
                                tracks.at(frame, shoulder) - tracks.at(frame, collar));
    }
  }
  keep_trunk_direction(trunk, world);
  if (!points.collars)
    lift_shoulders(trunk, tracks.at(frame, kLeftShoulder) - tracks.at(frame, kRightShoulder),
                   points, world);
  pose_head(tracks, points, frame, world);
}

}  // namespace mocaplm
