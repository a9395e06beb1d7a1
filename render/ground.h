// What lies behind a figure: sky, a floor at height 0 with a grid of half metres, and on it the
// figure's soft shadow.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "motion/body_mesh.h"
#include "render/camera.h"
#include "render/picture.h"

namespace mocaplm {

// How dark the floor is around a figure: a map of the floor seen from above.
class Shadow {
 public:
  Shadow(const MeshPoints& positions, const std::vector<std::uint16_t>& triangles);

  // 0 in the light to 1, at a place (x, z) of the floor in metres.
  float at(float x, float z) const;
  // The floor's square that it may darken.
  Eigen::Vector2f low() const { return low_; }
  Eigen::Vector2f high() const;

 private:
  void mark(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c);
  void soften();

  Eigen::Vector2f low_;
  std::vector<float> dark_;  // (kCells, kCells), row after row along z
};

class Ground {
 public:
  // `box` is what the figure's paths reach: the floor fades out around it.
  Ground(const Box& box, bool dark);

  // The whole picture without a figure.
  Picture empty(const Camera& camera, int width, int height) const;
  // Darkens the floor of a picture that `empty` made for this camera.
  void cast(const Shadow& shadow, const Camera& camera, Picture& picture) const;

 private:
  Eigen::Vector2f middle_;
  float reach_;
  Eigen::Vector3f sky_low_, sky_high_, floor_, line_;  // sRGB, 0 to 255
  float darkest_;
};

}  // namespace mocaplm
