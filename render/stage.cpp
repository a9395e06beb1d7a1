#include "render/stage.h"

#include <algorithm>

#include "common/angles.h"
#include "motion/skeleton.h"
#include "render/layer.h"

namespace mocaplm {

namespace {

constexpr int kFigureColour = 0x4f79ea, kPaleLight = 0xe3e8f6, kPaleDark = 0x3a4266;
constexpr double kSmoothSeconds = 0.6;  // of the followed way, to each side

// A running mean of the pelvis's way over the floor: a camera that follows every step shakes.
Translations smooth_way(const Clip& clip) {
  const auto reach = static_cast<Eigen::Index>(kSmoothSeconds * clip.fps);
  Translations way(clip.frames(), 3);
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const Eigen::Index from = std::max<Eigen::Index>(t - reach, 0);
    const Eigen::Index to = std::min(t + reach + 1, clip.frames());
    way.row(t) = clip.trans.middleRows(from, to - from).colwise().mean();
  }
  way.col(1).setZero();
  const Eigen::RowVector3d first = way.row(0);
  way.rowwise() -= first;
  return way;
}

}  // namespace

Stage::Stage(Clip clip, const RenderConfig& config)
    : config_(config),
      clip_(std::move(clip)),
      followed_(smooth_way(clip_)),
      first_camera_(camera(0)),
      ground_(whole_way(), config.dark),
      empty_(ground_.empty(first_camera_, static_cast<int>(config.width),
                           static_cast<int>(config.height))) {}

Box Stage::whole_way() const {
  Box box;
  for (Eigen::Index t = 0; t < clip_.frames(); ++t) {
    const JointPositions joints = joint_positions(clip_, t);
    box.add(joints.colwise().minCoeff().transpose().cast<float>());
    box.add(joints.colwise().maxCoeff().transpose().cast<float>());
  }
  // The body around the joints, the head above its joint, the floor, and room for who sits.
  box.low -= Eigen::Vector3f(.14f, 0, .14f);
  box.high += Eigen::Vector3f(.14f, .24f, .14f);
  box.low.y() = std::min(box.low.y(), 0.0f) - 0.08f;
  box.high.y() = std::max(box.high.y(), 1.4f);
  return box;
}

Camera Stage::camera(Eigen::Index frame) const {
  const auto made = [&](const Box& box) {
    return Camera(box, config_.turn * kRadians, config_.tilt * kRadians,
                  static_cast<int>(config_.width), static_cast<int>(config_.height));
  };
  if (!config_.follow) return made(whole_way());
  const Eigen::Vector3f pelvis =
      (clip_.trans.row(0) + rest_joints(clip_).row(0)).transpose().cast<float>();
  Box near;
  near.add({pelvis.x() - .8f, -.08f, pelvis.z() - .8f});
  near.add({pelvis.x() + .8f, 1.95f, pelvis.z() + .8f});
  Camera camera = made(near);
  camera.move(followed_.row(frame).transpose().cast<float>());
  return camera;
}

Picture Stage::draw(const std::vector<Eigen::Index>& frames, const Camera& camera,
                    Picture picture) const {
  const BodyMesh& mesh = body_mesh();
  const LinearColour full = linear_colour(kFigureColour);
  const LinearColour pale = linear_colour(config_.dark ? kPaleDark : kPaleLight);
  Layer layer(picture.width, picture.height);
  MeshPoints positions, normals;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    pose_body(clip_, frames[i], positions, normals);
    ground_.cast(Shadow(positions, mesh.triangles), camera, picture);
    const float early =
        static_cast<float>(frames.size() - 1 - i) / static_cast<float>(frames.size());
    layer.draw(camera, positions, normals, mesh.triangles, (1 - early) * full + early * pale);
  }
  layer.put_over(picture);
  return picture;
}

Picture Stage::frame(Eigen::Index frame) const {
  if (!config_.follow) return draw({frame}, first_camera_, empty_);
  const Camera seen = camera(frame);
  return draw({frame}, seen, ground_.empty(seen, empty_.width, empty_.height));
}

Picture Stage::poses(const std::vector<Eigen::Index>& frames) const {
  return draw(frames, first_camera_, empty_);
}

}  // namespace mocaplm
