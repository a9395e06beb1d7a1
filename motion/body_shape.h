// The shape of the figure that .glb files and rendered pictures show: closed skins over rings of
// points around SMPL's bones, made up here by eye (no scan, no SMPL mesh), each ring with the
// joints that carry it. The proportions are those of the page's figure (viewer/assets/body.js).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace mocaplm {

constexpr int kRingPoints = 16;

struct BodyRing {
  // In the rest pose, metres; counterclockwise for one who looks against the direction of the skin.
  std::array<Eigen::Vector3d, kRingPoints> points;
  int joints[2] = {0, 0};
  double second = 0;  // weight of the second joint; the first has the rest
};

// Two rings or more along a limb, closed at both ends by a fan to the end ring's middle.
using BodySkin = std::vector<BodyRing>;

// Legs, arms, shoulders, feet, trunk, neck, head.
std::vector<BodySkin> body_skins();

}  // namespace mocaplm
