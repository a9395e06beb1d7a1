#include "motion/body_mesh.h"

#include <Eigen/Geometry>

#include "motion/body_shape.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

class MeshBuilder {
 public:
  // Rings joined by triangles, and a fan at both ends.
  void add(const BodySkin& skin) {
    const auto first = static_cast<int>(points_.size());
    for (const BodyRing& ring : skin)
      for (const Eigen::Vector3d& point : ring.points) vertex(point, ring);
    for (int ring = 0; ring + 1 < static_cast<int>(skin.size()); ++ring)
      for (int i = 0; i < kRingPoints; ++i) {
        const int next = (i + 1) % kRingPoints, below = first + ring * kRingPoints;
        const int above = below + kRingPoints;
        triangle(below + i, below + next, above + next);
        triangle(below + i, above + next, above + i);
      }
    const int last = first + static_cast<int>(skin.size() - 1) * kRingPoints;
    const int bottom = vertex(middle(skin.front()), skin.front());
    const int top = vertex(middle(skin.back()), skin.back());
    for (int i = 0; i < kRingPoints; ++i) {
      const int next = (i + 1) % kRingPoints;
      triangle(bottom, first + next, first + i);
      triangle(top, last + i, last + next);
    }
  }

  BodyMesh finish() {
    BodyMesh mesh;
    const auto count = static_cast<Eigen::Index>(points_.size());
    mesh.positions.resize(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
      mesh.positions.row(i) = points_[static_cast<std::size_t>(i)].transpose().cast<float>();
    mesh.triangles = std::move(triangles_);
    mesh.carried = std::move(carried_);
    mesh.normals = smooth_normals(mesh.triangles);
    return mesh;
  }

 private:
  static Eigen::Vector3d middle(const BodyRing& ring) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : ring.points) sum += point;
    return sum / kRingPoints;
  }

  int vertex(const Eigen::Vector3d& point, const BodyRing& ring) {
    points_.push_back(point);
    BodyMesh::Carried carried{{0, 0}, {1, 0}};
    const auto second = static_cast<float>(ring.second);
    const bool one = ring.joints[0] == ring.joints[1] || second <= 0 || second >= 1;
    carried.joints[0] = static_cast<std::uint8_t>(ring.joints[one && second >= 1 ? 1 : 0]);
    if (!one) {
      carried.joints[1] = static_cast<std::uint8_t>(ring.joints[1]);
      carried.weights = {1 - second, second};
    }
    carried_.push_back(carried);
    return static_cast<int>(points_.size()) - 1;
  }

  void triangle(int a, int b, int c) {
    for (const int corner : {a, b, c}) triangles_.push_back(static_cast<std::uint16_t>(corner));
  }

  // The mean of the faces around a vertex, weighted by area.
  MeshPoints smooth_normals(const std::vector<std::uint16_t>& triangles) const {
    std::vector<Eigen::Vector3d> sums(points_.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      const Eigen::Vector3d& a = points_[triangles[i]];
      const Eigen::Vector3d face =
          (points_[triangles[i + 1]] - a).cross(points_[triangles[i + 2]] - a);
      for (std::size_t k = 0; k < 3; ++k) sums[triangles[i + k]] += face;
    }
    MeshPoints normals(static_cast<Eigen::Index>(sums.size()), 3);
    for (std::size_t i = 0; i < sums.size(); ++i)
      normals.row(static_cast<Eigen::Index>(i)) = sums[i].normalized().transpose().cast<float>();
    return normals;
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<BodyMesh::Carried> carried_;
  std::vector<std::uint16_t> triangles_;
};

}  // namespace

const BodyMesh& body_mesh() {
  static const BodyMesh mesh = [] {
    MeshBuilder builder;
    for (const BodySkin& skin : body_skins()) builder.add(skin);
    return builder.finish();
  }();
  return mesh;
}

void pose_body(const Clip& clip, Eigen::Index frame, MeshPoints& positions, MeshPoints& normals) {
  const BodyMesh& mesh = body_mesh();
  const auto world = joint_world_rotations(clip, frame);
  const JointPositions joints = joint_positions(clip, frame);
  std::array<Eigen::Matrix3f, kJoints> turn;
  std::array<Eigen::Vector3f, kJoints> shift;  // x -> turn x + shift
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    turn[j] = world[j].cast<float>();
    shift[j] =
        (joints.row(row).transpose() - world[j] * rest_joints().row(row).transpose()).cast<float>();
  }
  positions.resize(mesh.vertices(), 3);
  normals.resize(mesh.vertices(), 3);
  for (Eigen::Index v = 0; v < mesh.vertices(); ++v) {
    const BodyMesh::Carried& carried = mesh.carried[static_cast<std::size_t>(v)];
    const auto a = carried.joints[0], b = carried.joints[1];
    const Eigen::Matrix3f blend = carried.weights[0] * turn[a] + carried.weights[1] * turn[b];
    positions.row(v) = (blend * mesh.positions.row(v).transpose() + carried.weights[0] * shift[a] +
                        carried.weights[1] * shift[b])
                           .transpose();
    normals.row(v) = (blend * mesh.normals.row(v).transpose()).normalized().transpose();
  }
}

}  // namespace mocaplm
