#include "motion/formats/scene_takes.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <set>

#include "common/angles.h"
#include "common/error.h"
#include "motion/formats/scene_rate.h"
#include "motion/formats/scene_skeleton.h"
#include "motion/rotation.h"

namespace mocaplm {

namespace {

constexpr double kMaxTakeFrames = 1000000, kMaxTakeValues = 64 << 20;
constexpr double kFarthest = 1e7;  // metres
constexpr double kStays = 2e-5;    // of the skeleton's size: places nearer than this are the same
constexpr double kTurns = 1e-5;    // radians: smaller turns than this are none

using Matrix = Eigen::Matrix4d;
using FrameRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Vector3d place_of(const Matrix& matrix) {
  return matrix.topRightCorner<3, 1>();
}

// Keys joined by straight lines, asked for at times that never go back.
template <class Value, class Between>
auto value_at(const SceneKeys<Value>& keys, std::size_t& last, double time,
              const Between& between) {
  while (last + 1 < keys.times.size() && keys.times[last + 1] <= time) ++last;
  const std::size_t next = std::min(last + 1, keys.times.size() - 1);
  const double length = keys.times[next] - keys.times[last];
  const double share = length > 0 ? std::clamp((time - keys.times[last]) / length, 0.0, 1.0) : 0;
  return between(keys.values[last], keys.values[next], share);
}

class Track {
 public:
  explicit Track(const SceneTrack& track) : track_(track) {}
  Matrix local(double time) {
    const auto line = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b, double share) {
      return Eigen::Vector3d(a.cast<double>() + share * (b - a).cast<double>());
    };
    const auto arc = [](const Eigen::Quaternionf& a, const Eigen::Quaternionf& b, double share) {
      Eigen::Quaterniond from = a.cast<double>(), to = b.cast<double>();
      if (!(from.norm() > 1e-6 && to.norm() > 1e-6)) return Eigen::Quaterniond::Identity();
      return from.normalized().slerp(share, to.normalized());
    };
    Matrix local = Matrix::Identity();
    local.topLeftCorner<3, 3>() = value_at(track_.rotations, turn_, time, arc).toRotationMatrix() *
                                  value_at(track_.scales, scale_, time, line).asDiagonal();
    local.topRightCorner<3, 1>() = value_at(track_.positions, place_, time, line);
    return local;
  }

 private:
  const SceneTrack& track_;
  std::size_t place_ = 0, turn_ = 0, scale_ = 0;
};

// A scene that has no motion of a skeleton, said in its own terms.
[[noreturn]] void no_motion(const std::string& file, const std::string& what) {
  throw NoMotion(in_file(file), what);
}

class Sampler {
 public:
  Sampler(const Scene& scene, const SceneSkeleton& skeleton, const std::string& file, bool own_axes)
      : scene_(scene), skeleton_(skeleton), file_(file) {
    const Eigen::Matrix3d axes =
        own_axes ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : scene.axes;
    world_.topLeftCorner<3, 3>() = scene.unit * axes;
    const double most = rest_joints();
    for (std::size_t j = 0; j < joints(); ++j) {
      const Eigen::Matrix3d linear = rest(j).topLeftCorner<3, 3>();
      const double size = linear.norm();
      flat_.push_back(
          !(size > 1e-12 && std::abs(linear.determinant()) > 1e-9 * size * size * size));
      from_rest_.push_back(flat_.back() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                        : Eigen::Matrix3d(linear.inverse()));
    }
    size_ = most;
  }

  // The motion of a take; without joints where nothing moves.
  SceneMotion sample(const SceneTake& take) {
    SceneMotion motion;
    std::vector<double> times;
    for (const SceneTrack& track : take.tracks) {
      if (!std::binary_search(skeleton_.chain.begin(), skeleton_.chain.end(), track.node)) continue;
      for (const std::vector<double>* keys :
           {&track.positions.times, &track.rotations.times, &track.scales.times})
        if (keys->size() > 1) times.insert(times.end(), keys->begin(), keys->end());
    }
    if (times.empty() || !(take.end > take.begin)) return motion;
    SceneRate rate = scene_rate(std::move(times), take.begin, scene_.curves, take.name);
    const double frames = std::floor((take.end - take.begin) * rate.fps + 0.5) + 1;
    if (frames > kMaxTakeFrames || frames * 6 * static_cast<double>(joints()) > kMaxTakeValues)
      throw DataError(in_file(file_),
                      "take \"" + take.name + "\" has too much motion for one file; split it");
    pose_frames(take, rate.fps, static_cast<Eigen::Index>(frames));
    if (!moves()) return motion;
    motion.remarks = std::move(rate.remarks);
    motion.bvh = bvh(rate.fps);
    return motion;
  }

 private:
  std::size_t joints() const { return skeleton_.joints.size(); }
  Matrix rest(std::size_t joint) const {
    return world_ * skeleton_.rest[node_index(skeleton_.joints[joint].node)];
  }

  // Offsets of the joints in the rest pose; returns the skeleton's size.
  double rest_joints() {
    double most = 0;
    const Eigen::Vector3d origin = place_of(rest(0));
    for (std::size_t j = 0; j < joints(); ++j) {
      const int parent = skeleton_.joints[j].parent;
      const Eigen::Vector3d place = place_of(rest(j));
      offsets_.push_back(parent < 0 ? place
                                    : Eigen::Vector3d(place - place_of(rest(node_index(parent)))));
      most = std::max(most, (place - origin).norm());
      if (!(place.cwiseAbs().maxCoeff() <= kFarthest))
        throw DataError(in_file(file_), "joint " + name(j) + " lies farther away than 1e7 m");
    }
    return most;
  }
  const std::string& name(std::size_t joint) const {
    return scene_.nodes[node_index(skeleton_.joints[joint].node)].name;
  }

  // Local places and turns of all joints in all frames.
  void pose_frames(const SceneTake& take, double fps, Eigen::Index frames) {
    std::vector<Track> tracks(take.tracks.begin(), take.tracks.end());
    std::vector<Track*> track_of(scene_.nodes.size(), nullptr);
    for (std::size_t i = 0; i < tracks.size(); ++i)
      track_of[node_index(take.tracks[i].node)] = &tracks[i];
    const auto columns = static_cast<Eigen::Index>(3 * joints());
    places_.resize(frames, columns);
    turns_.resize(frames, columns);
    std::vector<Matrix> node(scene_.nodes.size());
    std::vector<Eigen::Matrix3d> turn(joints());
    for (Eigen::Index t = 0; t < frames; ++t) {
      const double time = std::min(take.begin + static_cast<double>(t) / fps, take.end);
      for (const int i : skeleton_.chain) {
        const int parent = scene_.nodes[node_index(i)].parent;
        const Matrix local = track_of[node_index(i)] ? track_of[node_index(i)]->local(time)
                                                     : scene_.nodes[node_index(i)].local;
        node[node_index(i)] = (parent < 0 ? world_ : node[node_index(parent)]) * local;
      }
      for (std::size_t j = 0; j < joints(); ++j) pose_joint(t, j, node, turn);
    }
  }

  void pose_joint(Eigen::Index t, std::size_t j, const std::vector<Matrix>& node,
                  std::vector<Eigen::Matrix3d>& turn) {
    const SceneJoint& joint = skeleton_.joints[j];
    const bool root = joint.parent < 0;
    const Eigen::Matrix3d before =
        root ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : turn[node_index(joint.parent)];
    const Matrix& place = node[node_index(joint.node)];
    turn[j] = turn_from_rest(t, j, place.topLeftCorner<3, 3>(), before);
    Eigen::Vector3d local = place_of(place);
    if (!root)
      local = before.transpose() *
              (local - place_of(node[node_index(skeleton_.joints[node_index(joint.parent)].node)]));
    if (!(local.cwiseAbs().maxCoeff() <= kFarthest))
      throw DataError(at_joint(file_, static_cast<std::size_t>(t), name(j)),
                      "lies farther away than 1e7 m");
    const auto column = static_cast<Eigen::Index>(3 * j);
    places_.row(t).segment<3>(column) = local.transpose();
    turns_.row(t).segment<3>(column) =
        kDegrees * euler_from_matrix(before.transpose() * turn[j], kZxy).transpose();
  }

  // The rotation in what turns, and may stretch, the rest pose into this frame's. A joint that is
  // scaled to nothing turns with its parent.
  Eigen::Matrix3d turn_from_rest(Eigen::Index t, std::size_t j, const Eigen::Matrix3d& now,
                                 const Eigen::Matrix3d& parent) const {
    if (flat_[j]) return parent;
    const Eigen::Matrix3d stretch = now * from_rest_[j];
    const double size = std::sqrt(stretch.squaredNorm() / 3), volume = stretch.determinant();
    if (!(size > 1e-6) || std::abs(volume) < 1e-6 * size * size * size) return parent;
    if (volume < 0)
      throw DataError(at_joint(file_, static_cast<std::size_t>(t), name(j)),
                      "is turned inside out: its scale is negative here and not at rest");
    const Eigen::Matrix3d turn = stretch / size, square = turn.transpose() * turn;
    // Nearly a rotation: one step of Newton's method leaves the square of the error.
    if ((square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-5)
      return 0.5 * turn * (3 * Eigen::Matrix3d::Identity() - square);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return svd.matrixU() * svd.matrixV().transpose();
  }

  double drift(std::size_t j, const Eigen::RowVector3d& from) const {
    return (places_.middleCols(static_cast<Eigen::Index>(3 * j), 3).rowwise() - from)
        .cwiseAbs()
        .maxCoeff();
  }
  bool moves() const {
    for (std::size_t j = 0; j < joints(); ++j) {
      const auto column = static_cast<Eigen::Index>(3 * j);
      if (drift(j, places_.row(0).segment<3>(column)) > kStays * std::max(size_, 1e-9)) return true;
      const Eigen::RowVector3d first = turns_.row(0).segment<3>(column);
      if ((turns_.middleCols(column, 3).rowwise() - first).cwiseAbs().maxCoeff() >
          kTurns * kDegrees)
        return true;
    }
    return false;
  }

  Bvh bvh(double fps) const {
    Bvh bvh;
    bvh.fps = fps;
    bvh.frame_time = 1 / fps;
    int columns = 0;
    for (std::size_t j = 0; j < joints(); ++j) {
      BvhJoint joint;
      joint.name = name(j);
      joint.parent = skeleton_.joints[j].parent;
      joint.offset = offsets_[j];
      joint.first_channel = columns;
      if (joint.parent < 0 || drift(j, offsets_[j].transpose()) > kStays * size_)
        joint.channels = {BvhChannel::x_position, BvhChannel::y_position, BvhChannel::z_position};
      for (const BvhChannel turn :
           {BvhChannel::z_rotation, BvhChannel::x_rotation, BvhChannel::y_rotation})
        joint.channels.push_back(turn);
      for (const Eigen::Vector3d& end : skeleton_.joints[j].end_sites)
        joint.end_sites.push_back(world_.topLeftCorner<3, 3>() * end);
      columns += static_cast<int>(joint.channels.size());
      bvh.joints.push_back(std::move(joint));
    }
    bvh.values.resize(places_.rows(), columns);
    for (std::size_t j = 0; j < joints(); ++j) {
      const auto column = static_cast<Eigen::Index>(3 * j);
      Eigen::Index to = bvh.joints[j].first_channel;
      if (bvh.joints[j].channels.size() == 6) {
        bvh.values.middleCols(to, 3) = places_.middleCols(column, 3);
        to += 3;
      }
      bvh.values.middleCols(to, 3) = turns_.middleCols(column, 3);
    }
    return bvh;
  }

  const Scene& scene_;
  const SceneSkeleton& skeleton_;
  const std::string& file_;
  Matrix world_ = Matrix::Identity();
  std::vector<bool> flat_;  // scaled to nothing in one direction at rest
  std::vector<Eigen::Matrix3d> from_rest_;
  std::vector<Eigen::Vector3d> offsets_;
  double size_ = 0;
  FrameRows places_, turns_;  // (frames, 3 x joints): metres, degrees
};

std::string clean(const std::string& name, std::set<std::string>& taken) {
  std::string clean = name.substr(0, 120);
  for (char& c : clean)
    if (static_cast<unsigned char>(c) < 32 || c == 127 || c == '/') c = '_';
  if (clean.empty()) clean = "take";
  const std::string given = clean;
  for (int n = 2; !taken.insert(clean).second; ++n) clean = given + "_" + std::to_string(n);
  return clean;
}

}  // namespace

SceneMotions scene_motions(const Scene& scene, const std::string& file, bool own_axes) {
  const SceneSkeleton skeleton = scene_skeleton(scene, file);
  if (skeleton.joints.empty())
    no_motion(file, "has " + std::to_string(scene.meshes) +
                        " meshes, no skeleton and no animation, so no motion");
  if (scene.takes.empty())
    no_motion(file, "has a skeleton of " + std::to_string(skeleton.joints.size()) +
                        " joints and no animation, so no motion");
  SceneMotions found;
  Sampler sampler(scene, skeleton, file, own_axes);
  std::set<std::string> taken;
  for (const SceneTake& take : scene.takes) {
    const std::string name = clean(take.name, taken);
    SceneMotion motion = sampler.sample(take);
    if (motion.bvh.joints.empty()) {
      found.remarks.push_back(
          {"take without motion", "take \"" + name + "\" moves no joint and was left out"});
      continue;
    }
    motion.name = name;
    found.motions.push_back(std::move(motion));
  }
  if (found.motions.empty())
    no_motion(file, "has a skeleton of " + std::to_string(skeleton.joints.size()) +
                        " joints, and none of its " + std::to_string(scene.takes.size()) +
                        " takes moves it");
  return found;
}

}  // namespace mocaplm
