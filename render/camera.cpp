#include "render/camera.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

namespace {

constexpr double kFieldOfView = 24 * kPi / 180;  // of the picture's height
constexpr float kMargin = 1.04f;

}  // namespace

Camera::Camera(const Box& box, double turn, double tilt, int width, int height) {
  const auto s = static_cast<float>(std::sin(turn)), c = static_cast<float>(std::cos(turn));
  const auto ts = static_cast<float>(std::sin(tilt)), tc = static_cast<float>(std::cos(tilt));
  axes_ << c, 0, -s, -s * ts, tc, -c * ts, s * tc, ts, c * tc;
  scale_ = static_cast<float>(height / 2.0 / std::tan(kFieldOfView / 2));
  middle_x_ = static_cast<float>(width) / 2;
  middle_y_ = static_cast<float>(height) / 2;

  // A corner at (x, y, z) from the middle is seen when the camera is at least z + scale |x| / half
  // a width away.
  const Eigen::Vector3f middle = (box.low + box.high) / 2, half = (box.high - box.low) / 2;
  float away = 1;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f p =
        axes_ * Eigen::Vector3f((corner & 1 ? 1 : -1) * half.x(), (corner & 2 ? 1 : -1) * half.y(),
                                (corner & 4 ? 1 : -1) * half.z());
    away = std::max({away, p.z() + kMargin * scale_ * std::abs(p.x()) / middle_x_,
                     p.z() + kMargin * scale_ * std::abs(p.y()) / middle_y_});
  }
  eye_ = middle + away * back();
}

Eigen::Vector3f Camera::project(const Eigen::Vector3f& point) const {
  const Eigen::Vector3f p = axes_ * (point - eye_);
  const float distance = -p.z();
  return {middle_x_ + scale_ * p.x() / distance, middle_y_ - scale_ * p.y() / distance, distance};
}

Eigen::Vector3f Camera::ray(float x, float y) const {
  return axes_.transpose() *
         Eigen::Vector3f((x - middle_x_) / scale_, (middle_y_ - y) / scale_, -1);
}

Camera Camera::doubled() const {
  Camera camera = *this;
  camera.scale_ *= 2;
  camera.middle_x_ *= 2;
  camera.middle_y_ *= 2;
  return camera;
}

}  // namespace mocaplm
