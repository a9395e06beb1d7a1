#include "render/layer.h"

#include <algorithm>
#include <cmath>

namespace mocaplm {

namespace {

constexpr float kNearest = 0.05f;  // metres in front of the camera

float to_srgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

// sRGB bytes of 4,096 steps of light.
std::uint8_t srgb_byte(float linear) {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 4096; ++i)
      bytes.push_back(
          static_cast<std::uint8_t>(std::lround(255 * to_srgb(static_cast<float>(i) / 4095))));
    return bytes;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0f, 1.0f) * 4095)];
}

// The page's lights (viewer/assets/stage.js): sky and ground, a warm key, a cool rim; and a soft
// gleam.
LinearColour lit(const LinearColour& colour, const Eigen::Vector3f& normal,
                 const Eigen::Vector3f& towards_camera) {
  static const Eigen::Vector3f key = Eigen::Vector3f(6, 15, 9).normalized();
  static const Eigen::Vector3f rim = Eigen::Vector3f(-2, 3, -4).normalized();
  static const LinearColour sky(1, 1, 1), ground(.184f, .174f, .254f);
  static const LinearColour key_light(.88f, .80f, .70f), rim_light(.26f, .32f, .5f);
  const float up = 0.5f + 0.5f * normal.y();
  const LinearColour light = 0.58f * (up * sky + (1 - up) * ground) +
                             std::max(normal.dot(key), 0.0f) * key_light +
                             std::max(normal.dot(rim), 0.0f) * rim_light;
  const float gleam = std::max(normal.dot((key + towards_camera).normalized()), 0.0f);
  const float g2 = gleam * gleam, g4 = g2 * g2, g16 = g4 * g4 * g4 * g4;
  return colour.cwiseProduct(light) + 0.06f * g16 * key_light;
}

}  // namespace

LinearColour linear_colour(int hex) {
  LinearColour colour;
  for (int i = 0; i < 3; ++i) {
    const double c = (hex >> (16 - 8 * i) & 0xff) / 255.0;
    colour[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return colour;
}

Layer::Layer(int width, int height)
    : width_(2 * width),
      height_(2 * height),
      nearness_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0f),
      rgb_(nearness_.size()) {}

void Layer::draw(const Camera& camera, const MeshPoints& positions, const MeshPoints& normals,
                 const std::vector<std::uint16_t>& triangles, const LinearColour& colour) {
  const Camera fine = camera.doubled();
  std::vector<Corner> corners(static_cast<std::size_t>(positions.rows()));
  for (std::size_t v = 0; v < corners.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    corners[v].at = fine.project(positions.row(row).transpose());
    corners[v].at.z() = corners[v].at.z() < kNearest ? 0 : 1 / corners[v].at.z();
    corners[v].normal = normals.row(row).transpose();
  }
  const Paint paint = {colour, camera.back()};
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    triangle(corners[triangles[i]], corners[triangles[i + 1]], corners[triangles[i + 2]], paint);
}

void Layer::triangle(const Corner& a, const Corner& b, const Corner& c, const Paint& paint) {
  if (a.at.z() == 0 || b.at.z() == 0 || c.at.z() == 0) return;
  // Twice the area; the picture's y points down, so counterclockwise in the world is negative here.
  const float area =
      (b.at.x() - a.at.x()) * (c.at.y() - a.at.y()) - (c.at.x() - a.at.x()) * (b.at.y() - a.at.y());
  if (!(area < 0)) return;
  const auto first = [](float low, int end) {
    return static_cast<int>(std::clamp(std::ceil(low - 0.5f), 0.0f, static_cast<float>(end)));
  };
  const auto [left, right] = std::minmax({a.at.x(), b.at.x(), c.at.x()});
  const auto [top, bottom] = std::minmax({a.at.y(), b.at.y(), c.at.y()});
  const int x_end = first(right, width_), y_end = first(bottom, height_);
  for (int y = first(top, height_); y < y_end; ++y)
    for (int x = first(left, width_); x < x_end; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      // Shares of the corners: areas of the triangles that the point makes with the other two.
      const float wa =
          ((b.at.x() - px) * (c.at.y() - py) - (c.at.x() - px) * (b.at.y() - py)) / area;
      const float wb =
          ((c.at.x() - px) * (a.at.y() - py) - (a.at.x() - px) * (c.at.y() - py)) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const float nearness = wa * a.at.z() + wb * b.at.z() + wc * c.at.z();
      const std::size_t point = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                static_cast<std::size_t>(x);
      if (nearness <= nearness_[point]) continue;
      nearness_[point] = nearness;
      const Eigen::Vector3f normal = (wa * a.normal + wb * b.normal + wc * c.normal).normalized();
      const LinearColour light = lit(paint.colour, normal, paint.towards_camera);
      rgb_[point] = {srgb_byte(light[0]), srgb_byte(light[1]), srgb_byte(light[2])};
    }
}

void Layer::put_over(Picture& picture) const {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      int covered = 0, sum[3] = {0, 0, 0};
      for (const int dy : {0, 1})
        for (const int dx : {0, 1}) {
          const std::size_t point =
              static_cast<std::size_t>(2 * y + dy) * static_cast<std::size_t>(width_) +
              static_cast<std::size_t>(2 * x + dx);
          if (nearness_[point] == 0) continue;
          ++covered;
          for (int i = 0; i < 3; ++i) sum[i] += rgb_[point][static_cast<std::size_t>(i)];
        }
      if (covered == 0) continue;
      std::uint8_t* pixel = picture.at(x, y);
      for (int i = 0; i < 3; ++i)
        pixel[i] = static_cast<std::uint8_t>((sum[i] + (4 - covered) * pixel[i] + 2) / 4);
    }
}

}  // namespace mocaplm
