// A low-poly human figure as triangles that follow SMPL's joints (linear blend skinning).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

// (V, 3), row after row.
using MeshPoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct BodyMesh {
  // How a vertex follows its joints: the second one has weight 0, and is joint 0, where one is
  // enough.
  struct Carried {
    std::array<std::uint8_t, 2> joints;
    std::array<float, 2> weights;  // together 1
  };

  MeshPoints positions;          // in the rest pose, metres, where rest_joints() has the joints
  MeshPoints normals;            // outward, length 1
  std::vector<Carried> carried;  // (V)
  std::vector<std::uint16_t> triangles;  // (F, 3) counterclockwise seen from outside

  Eigen::Index vertices() const { return positions.rows(); }
};

// The figure, made at the first call. Its soles lie kSoleBelowFoot (motion/floor.h) below the foot
// joints.
const BodyMesh& body_mesh();

// Positions and normals of one frame, (V, 3) each; their storage is reused.
void pose_body(const Clip& clip, Eigen::Index frame, MeshPoints& positions, MeshPoints& normals);

}  // namespace mocaplm
