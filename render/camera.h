// From the world to the picture: a pinhole camera.
#pragma once

#include <Eigen/Core>

namespace mocaplm {

// A box in the world, metres, around what is to be seen.
struct Box {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9f), high = -low;

  void add(const Eigen::Vector3f& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

class Camera {
 public:
  // Looks at the box's middle from `turn` radians about +Y (0: from +Z) and `tilt` radians above
  // the horizontal, from so far that all of the box is in a picture of width x height pixels.
  Camera(const Box& box, double turn, double tilt, int width, int height);

  // Moves it over the ground.
  void move(const Eigen::Vector3f& way) { eye_ += way; }

  // Pixels from the picture's upper left corner, and in z the distance in front of the camera,
  // metres; where that is not positive the pixels mean nothing.
  Eigen::Vector3f project(const Eigen::Vector3f& point) const;

  // The direction in which the camera sees a pixel, not of unit length.
  Eigen::Vector3f ray(float x, float y) const;
  const Eigen::Vector3f& eye() const { return eye_; }
  // Towards the camera.
  Eigen::Vector3f back() const { return axes_.row(2).transpose(); }

  // The same view in pixels of half the size.
  Camera doubled() const;

 private:
  Eigen::Matrix3f axes_;  // rows: right, up, back
  Eigen::Vector3f eye_;
  float scale_;  // pixels a metre at a distance of one metre
  float middle_x_, middle_y_;
};

}  // namespace mocaplm
