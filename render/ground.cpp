#include "render/ground.h"

#include <algorithm>
#include <cmath>

namespace mocaplm {

namespace {

constexpr int kCells = 288;              // of a shadow's map, each way
constexpr float kCell = 0.0125f;         // metres
constexpr int kSoft = 2, kSoftened = 3;  // cells of the blur to each side, times

// Where the shadow of a point at height y lies beside it, for each metre of y.
const Eigen::Vector2f kSlope(-0.22f, -0.3f);

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// How much of a pixel that is `wide` metres wide a grid of this size covers at a place: lines of
// about 1.3 pixels, none where they would run together.
float grid_line(float size, const Eigen::Vector2f& spot, const Eigen::Vector2f& wide) {
  float most = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const float at = spot[axis] / size, width = std::max(wide[axis] / size, 1e-6f);
    const float away = std::abs(at - std::round(at));
    most = std::max(most, 1 - smooth_step(0, 1.3f * width, away));
  }
  return most * (1 - smooth_step(.15f, .5f, wide.maxCoeff() / size));
}

Eigen::Vector3f srgb(int hex) {
  return {static_cast<float>(hex >> 16 & 0xff), static_cast<float>(hex >> 8 & 0xff),
          static_cast<float>(hex & 0xff)};
}

void put(const Eigen::Vector3f& colour, std::uint8_t* pixel) {
  for (int i = 0; i < 3; ++i)
    pixel[i] = static_cast<std::uint8_t>(std::clamp(colour[i] + 0.5f, 0.0f, 255.0f));
}

// Where the camera sees the floor through a pixel, (x, z) in metres; false above the horizon.
bool floor_spot(const Camera& camera, float x, float y, Eigen::Vector2f& spot) {
  const Eigen::Vector3f ray = camera.ray(x, y);
  if (ray.y() > -1e-4f) return false;
  const Eigen::Vector3f hit = camera.eye() - camera.eye().y() / ray.y() * ray;
  spot = {hit.x(), hit.z()};
  return true;
}

}  // namespace

Shadow::Shadow(const MeshPoints& positions, const std::vector<std::uint16_t>& triangles)
    : dark_(kCells * kCells, 0.0f) {
  std::vector<Eigen::Vector2f> flat(static_cast<std::size_t>(positions.rows()));
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (std::size_t v = 0; v < flat.size(); ++v) {
    const Eigen::RowVector3f p = positions.row(static_cast<Eigen::Index>(v));
    flat[v] = Eigen::Vector2f(p.x(), p.z()) + std::max(p.y(), 0.0f) * kSlope;
    middle += flat[v] / static_cast<float>(flat.size());
  }
  low_ = middle - Eigen::Vector2f::Constant(kCells * kCell / 2);
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    mark(flat[triangles[i]], flat[triangles[i + 1]], flat[triangles[i + 2]]);
  soften();
}

Eigen::Vector2f Shadow::high() const {
  return low_ + Eigen::Vector2f::Constant(kCells * kCell);
}

void Shadow::mark(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
  const auto cell = [&](float at, int axis) {
    const float found = (at - low_[axis]) / kCell - 0.5f;
    return static_cast<int>(std::clamp(std::ceil(found), 0.0f, static_cast<float>(kCells)));
  };
  const auto cross = [](const Eigen::Vector2f& u, const Eigen::Vector2f& v) {
    return u.x() * v.y() - u.y() * v.x();
  };
  const Eigen::Vector2f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  for (int z = cell(low.y(), 1); z < cell(high.y(), 1); ++z)
    for (int x = cell(low.x(), 0); x < cell(high.x(), 0); ++x) {
      const Eigen::Vector2f p = low_ + kCell * Eigen::Vector2f(static_cast<float>(x) + 0.5f,
                                                               static_cast<float>(z) + 0.5f);
      const float u = cross(b - a, p - a), v = cross(c - b, p - b), w = cross(a - c, p - c);
      if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))
        dark_[static_cast<std::size_t>(z * kCells + x)] = 1;
    }
}

// A running mean along rows and columns, some times: nearly a Gaussian.
void Shadow::soften() {
  std::vector<float> line(kCells);
  for (int pass = 0; pass < 2 * kSoftened; ++pass) {
    const int along = pass % 2 == 0 ? 1 : kCells, across = pass % 2 == 0 ? kCells : 1;
    for (int row = 0; row < kCells; ++row) {
      float* cells = dark_.data() + row * across;
      for (int i = 0; i < kCells; ++i) {
        float sum = 0;
        for (int k = std::max(i - kSoft, 0); k <= std::min(i + kSoft, kCells - 1); ++k)
          sum += cells[k * along];
        line[static_cast<std::size_t>(i)] = sum / (2 * kSoft + 1);
      }
      for (int i = 0; i < kCells; ++i) cells[i * along] = line[static_cast<std::size_t>(i)];
    }
  }
}

float Shadow::at(float x, float z) const {
  const float u = (x - low_.x()) / kCell - 0.5f, v = (z - low_.y()) / kCell - 0.5f;
  if (!(u >= 0 && v >= 0 && u < kCells - 1 && v < kCells - 1)) return 0;
  const auto i = static_cast<std::size_t>(u), k = static_cast<std::size_t>(v);
  const float s = u - static_cast<float>(i), t = v - static_cast<float>(k);
  const float* cell = dark_.data() + k * kCells + i;
  return (1 - t) * ((1 - s) * cell[0] + s * cell[1]) +
         t * ((1 - s) * cell[kCells] + s * cell[kCells + 1]);
}

Ground::Ground(const Box& box, bool dark)
    : middle_((box.low.x() + box.high.x()) / 2, (box.low.z() + box.high.z()) / 2),
      reach_(1.5f * std::max((box.high - box.low).norm(), 4.0f)),
      sky_low_(srgb(dark ? 0x1b2033 : 0xdde3f1)),
      sky_high_(srgb(dark ? 0x10131f : 0xf4f6fb)),
      floor_(srgb(dark ? 0x2d3350 : 0xf8f9fc)),
      line_(srgb(dark ? 0x8f9cc8 : 0x7d88a8)),
      darkest_(dark ? 0.55f : 0.36f) {}

Picture Ground::empty(const Camera& camera, int width, int height) const {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    const float down = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    const Eigen::Vector3f sky = (1 - down) * sky_high_ + down * sky_low_;
    for (int x = 0; x < width; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      Eigen::Vector3f colour = sky;
      Eigen::Vector2f spot, beside, below;
      if (floor_spot(camera, px, py, spot) && floor_spot(camera, px + 1, py, beside) &&
          floor_spot(camera, px, py + 1, below)) {
        const Eigen::Vector2f wide = (beside - spot).cwiseAbs() + (below - spot).cwiseAbs();
        const float line =
            std::max(.30f * grid_line(.5f, spot, wide), .5f * grid_line(2, spot, wide));
        const float seen =
            (1 - smooth_step(.35f, 1, (spot - middle_).norm() / reach_)) * std::max(.55f, line);
        colour = (1 - seen) * sky + seen * ((1 - line) * floor_ + line * line_);
      }
      put(colour, picture.at(x, y));
    }
  }
  return picture;
}

void Ground::cast(const Shadow& shadow, const Camera& camera, Picture& picture) const {
  // Only the part of the picture where the shadow's square may be.
  float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
  for (const float x : {shadow.low().x(), shadow.high().x()})
    for (const float z : {shadow.low().y(), shadow.high().y()}) {
      const Eigen::Vector3f at = camera.project({x, 0, z});
      const bool seen = at.z() > 0.05f;  // else: anywhere
      left = std::min(left, seen ? at.x() : 0);
      right = std::max(right, seen ? at.x() : 1e9f);
      top = std::min(top, seen ? at.y() : 0);
      bottom = std::max(bottom, seen ? at.y() : 1e9f);
    }
  const auto pixel = [](float at, int end) {
    return static_cast<int>(std::clamp(at, 0.0f, static_cast<float>(end)));
  };
  for (int y = pixel(top, picture.height); y < pixel(bottom + 1, picture.height); ++y)
    for (int x = pixel(left, picture.width); x < pixel(right + 1, picture.width); ++x) {
      Eigen::Vector2f spot;
      if (!floor_spot(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, spot))
        continue;
      const float light = 1 - darkest_ * shadow.at(spot.x(), spot.y());
      std::uint8_t* at = picture.at(x, y);
      if (light < 1)
        put(light * Eigen::Vector3f(static_cast<float>(at[0]), static_cast<float>(at[1]),
                                    static_cast<float>(at[2])),
            at);
    }
}

}  // namespace mocaplm
