#include "motion/body_mesh.h"

#include <gtest/gtest.h>

#include <map>

#include "motion/floor.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::body_mesh_test {
namespace {

Eigen::Vector3d corner(const BodyMesh& mesh, std::size_t i) {
  return mesh.positions.row(mesh.triangles[i]).transpose().cast<double>();
}

// Every edge is walked once in each direction: no holes, no face turned inside out beside others.
TEST(BodyMesh, IsClosed) {
  const BodyMesh& mesh = body_mesh();
  ASSERT_EQ(mesh.triangles.size() % 3, 0u);
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      ++edges[{mesh.triangles[i + k], mesh.triangles[i + (k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(BodyMesh, IsAsFineAsTheDocumentsSay) {  // docs/convert.md
  EXPECT_EQ(body_mesh().vertices(), 3742);
  EXPECT_EQ(body_mesh().triangles.size(), 3u * 7424);
}

TEST(BodyMesh, IsTurnedOutward) {
  const BodyMesh& mesh = body_mesh();
  double volume = 0;
  int against = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Eigen::Vector3d a = corner(mesh, i), b = corner(mesh, i + 1), c = corner(mesh, i + 2);
    volume += a.dot(b.cross(c)) / 6;
    const Eigen::Vector3d face = (b - a).cross(c - a);
    for (std::size_t k = 0; k < 3; ++k)
      against += face.dot(mesh.normals.row(mesh.triangles[i + k]).transpose().cast<double>()) < 0;
  }
  // Parts that overlap count twice: somewhat more than a person's 65 litres.
  EXPECT_GT(volume, 0.05);
  EXPECT_LT(volume, 0.12);
  EXPECT_LT(against, static_cast<int>(mesh.triangles.size() / 100));
  for (Eigen::Index v = 0; v < mesh.vertices(); ++v)
    ASSERT_NEAR(mesh.normals.row(v).norm(), 1, 1e-5);
}

TEST(BodyMesh, IsAsTallAsAPersonAndStandsOnItsSoles) {
  const BodyMesh& mesh = body_mesh();
  const double low = mesh.positions.col(1).minCoeff(), high = mesh.positions.col(1).maxCoeff();
  EXPECT_NEAR(low, rest_joints().col(1).minCoeff() - kSoleBelowFoot, 0.004);
  EXPECT_GT(high - low, 1.6);
  EXPECT_LT(high - low, 1.85);
  // Finger tips.
  EXPECT_NEAR(mesh.positions.col(0).maxCoeff(), 0.85, 0.05);
  EXPECT_NEAR(mesh.positions.col(0).minCoeff(), -0.85, 0.05);
}

TEST(BodyMesh, FollowsItsJointsWithWeightsThatSumToOne) {
  const BodyMesh& mesh = body_mesh();
  ASSERT_EQ(mesh.carried.size(), static_cast<std::size_t>(mesh.vertices()));
  std::map<int, int> used;
  for (const BodyMesh::Carried& carried : mesh.carried) {
    ASSERT_FLOAT_EQ(carried.weights[0] + carried.weights[1], 1);
    ASSERT_GT(carried.weights[0], 0);
    ASSERT_GE(carried.weights[1], 0);
    if (carried.weights[1] == 0) {
      ASSERT_EQ(carried.joints[1], 0);
    } else {
      ASSERT_NE(carried.joints[0], carried.joints[1]);
      ASSERT_LT(carried.joints[1], kJoints);
    }
    ASSERT_LT(carried.joints[0], kJoints);
    ++used[carried.joints[0]];
  }
  EXPECT_GT(used.size(), 18u);
}

// The rest pose is the mesh; a turn of the pelvis turns all of it; a bent knee moves the shin
// alone.
TEST(BodyMesh, Poses) {
  Clip clip;
  clip.fps = 30;
  clip.poses = Poses::Zero(3, 72);
  clip.trans = Translations::Zero(3, 3);
  clip.poses.row(1).head<3>() << 0, 1.2, 0;
  clip.trans.row(1) << 1, 2, 3;
  clip.poses.row(2).segment<3>(3 * 4) << 1.5, 0, 0;
  const BodyMesh& mesh = body_mesh();
  MeshPoints positions, normals;
  pose_body(clip, 0, positions, normals);
  EXPECT_LT((positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((normals - mesh.normals).cwiseAbs().maxCoeff(), 1e-5);

  pose_body(clip, 1, positions, normals);
  const Eigen::Matrix3d turn = matrix_from_axis_angle({0, 1.2, 0});
  const Eigen::RowVector3d pelvis = rest_joints().row(0);
  for (Eigen::Index v = 0; v < mesh.vertices(); v += 17) {
    const Eigen::RowVector3d from_pelvis = mesh.positions.row(v).cast<double>() - pelvis;
    const Eigen::RowVector3d wanted =
        from_pelvis * turn.transpose() + pelvis + Eigen::RowVector3d(1, 2, 3);
    ASSERT_LT((positions.row(v).cast<double>() - wanted).norm(), 1e-5);
  }

  pose_body(clip, 2, positions, normals);
  for (Eigen::Index v = 0; v < mesh.vertices(); ++v) {
    const bool shin = mesh.positions(v, 0) > 0 && mesh.positions(v, 1) < -0.8;
    const float moved = (positions.row(v) - mesh.positions.row(v)).norm();
    if (shin) {
      ASSERT_GT(moved, 0.05);
    } else if (mesh.positions(v, 0) < 0 || mesh.positions(v, 1) > -0.6) {
      ASSERT_LT(moved, 1e-6);
    }
  }
}

}  // namespace
}  // namespace mocaplm::body_mesh_test
