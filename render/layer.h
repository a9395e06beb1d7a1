// Triangles drawn with a depth buffer, four points a pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "motion/body_mesh.h"
#include "render/camera.h"
#include "render/picture.h"

namespace mocaplm {

// Red, green, blue.
using LinearColour = Eigen::Vector3f;  // in [0, 1], proportional to light
LinearColour linear_colour(int hex);   // 0x4f79ea

class Layer {
 public:
  Layer(int width, int height);

  // Draws a smooth surface: normals are interpolated, lit from above and a little from behind.
  // Faces turned away, and those that reach behind the camera, are left out.
  void draw(const Camera& camera, const MeshPoints& positions, const MeshPoints& normals,
            const std::vector<std::uint16_t>& triangles, const LinearColour& colour);

  // Puts what was drawn over the picture, which has the layer's size.
  void put_over(Picture& picture) const;

 private:
  struct Corner {
    Eigen::Vector3f at;      // pixels of this layer; z: 1 / distance
    Eigen::Vector3f normal;  // in the world
  };
  struct Paint {
    LinearColour colour;
    Eigen::Vector3f towards_camera;
  };

  void triangle(const Corner& a, const Corner& b, const Corner& c, const Paint& paint);

  int width_, height_;           // in points, twice the picture's
  std::vector<float> nearness_;  // 1 / distance; 0: nothing there
  std::vector<std::array<std::uint8_t, 3>> rgb_;
};

}  // namespace mocaplm
