#include "motion/formats/scene_skeleton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/error.h"
#include "motion/formats/joint_limits.h"

namespace mocaplm {

namespace {

constexpr double kSamePlace = 1e-3;  // of the skeleton's size
constexpr double kSameTurn = 2e-3;   // radians
constexpr double kUnlike = 0.75;     // of the skeleton's size: no pose of the same skeleton

using Places = std::vector<Eigen::Matrix4d>;

bool invertible(const Eigen::Matrix4d& matrix) {
  const double size = matrix.topLeftCorner<3, 3>().norm();
  return size > 1e-9 &&
         std::abs(matrix.topLeftCorner<3, 3>().determinant()) > 1e-9 * size * size * size;
}

// The angle between the axes of two places, whatever their scales.
double turn_of_places(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  const Eigen::Matrix3d turn = a.topLeftCorner<3, 3>() * b.topLeftCorner<3, 3>().inverse();
  const double scale = std::cbrt(std::abs(turn.determinant()));
  return scale > 0 ? std::acos(std::clamp((turn.trace() / scale - 1) / 2, -1.0, 1.0)) : 0;
}

// The pose of one skin: where its bones were when it was bound, up to a common turn, scale and
// shift, which formats and exporters take differently.
class BindPose {
 public:
  BindPose(const SceneSkin& skin, const Places& nodes) : nodes_(nodes) {
    for (const SceneBone& bone : skin.bones)
      if (invertible(bone.from_mesh) && invertible(nodes[node_index(bone.node)]))
        bones_.push_back({bone.node, bone.from_mesh.inverse()});
    if (bones_.empty()) return;
    std::sort(bones_.begin(), bones_.end(),
              [](const Bone& a, const Bone& b) { return a.node < b.node; });
    size_ = size();
    // In the world; in the mesh's axes; or so that its first bone lies where its node does.
    for (const Eigen::Matrix4d& to_world :
         {Eigen::Matrix4d(Eigen::Matrix4d::Identity()), nodes[node_index(skin.mesh_node)],
          Eigen::Matrix4d(nodes[node_index(bones_.front().node)] *
                          bones_.front().place.inverse())}) {
      const double error = distance(to_world);
      if (error < error_) {
        error_ = error;
        to_world_ = to_world;
      }
    }
  }
  bool usable() const { return error_ < kUnlike; }
  bool differs() const {
    return error_ > kSamePlace || std::any_of(bones_.begin(), bones_.end(), [&](const Bone& bone) {
             return turn_of_places(to_world_ * bone.place, nodes_[node_index(bone.node)]) >
                    kSameTurn;
           });
  }
  template <class Use>
  void each(const Use& use) const {
    for (const Bone& bone : bones_) use(bone.node, to_world_ * bone.place);
  }

 private:
  struct Bone {
    int node;
    Eigen::Matrix4d place;  // in the bind pose, in the axes of the skin
  };

  Eigen::Vector3d node(const Bone& bone) const {
    return nodes_[node_index(bone.node)].topRightCorner<3, 1>();
  }
  double size() const {
    double most = 0;
    for (const Bone& bone : bones_)
      most = std::max(most, (node(bone) - node(bones_.front())).norm());
    return most;
  }
  // Root of the mean square over the bones, in parts of the skeleton's size.
  double distance(const Eigen::Matrix4d& to_world) const {
    if (!invertible(to_world)) return std::numeric_limits<double>::infinity();
    if (!(size_ > 0)) return 0;
    double sum = 0;
    for (const Bone& bone : bones_)
      sum += ((to_world * bone.place).topRightCorner<3, 1>() - node(bone)).squaredNorm();
    return std::sqrt(sum / static_cast<double>(bones_.size())) / size_;
  }

  const Places& nodes_;
  std::vector<Bone> bones_;
  double size_ = 0, error_ = std::numeric_limits<double>::infinity();
  Eigen::Matrix4d to_world_ = Eigen::Matrix4d::Identity();
};

class SkeletonFinder {
 public:
  SkeletonFinder(const Scene& scene, const std::string& file)
      : scene_(scene), file_(file), chosen_(scene.nodes.size()), moved_(scene.nodes.size()) {}

  SceneSkeleton find() {
    choose();
    if (std::find(chosen_.begin(), chosen_.end(), true) == chosen_.end()) return {};
    std::vector<bool> inside = chosen_;  // with all above
    for (std::size_t i = inside.size(); i-- > 1;)
      if (inside[i]) inside[node_index(scene_.nodes[i].parent)] = true;
    const std::size_t top = top_of(inside);
    std::vector<int> joint(inside.size(), -1), depth(inside.size(), 0);
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside[i]) skeleton_.chain.push_back(static_cast<int>(i));
      if (!inside[i] || i < top || helper(i)) continue;
      if (skeleton_.joints.size() == kMaxJoints)
        throw DataError(in_file(file_), "more than " + std::to_string(kMaxJoints) + " joints");
      const int parent = node_above(i);
      SceneJoint made;
      made.node = static_cast<int>(i);
      made.parent = i == top ? -1 : joint[node_index(parent)];
      depth[i] = i == top ? 1 : depth[node_index(parent)] + 1;
      if (depth[i] > static_cast<int>(kMaxJointDepth))
        throw DataError(in_file(file_),
                        "joints are nested more than " + std::to_string(kMaxJointDepth) + " deep");
      joint[i] = static_cast<int>(skeleton_.joints.size());
      skeleton_.joints.push_back(made);
    }
    rest();
    end_sites(inside, joint);
    return std::move(skeleton_);
  }

 private:
  bool helper(std::size_t node) const { return scene_.nodes[node].kind == SceneNodeKind::helper; }
  // The node that a helper leads to: those of one chain follow each other.
  std::size_t owner(std::size_t node) const {
    while (helper(node) && node + 1 < scene_.nodes.size() &&
           scene_.nodes[node + 1].parent == static_cast<int>(node))
      ++node;
    return node;
  }
  // The nearest node above that is no helper; -1 for none.
  int node_above(std::size_t node) const {
    int above = scene_.nodes[node].parent;
    while (above >= 0 && helper(node_index(above))) above = scene_.nodes[node_index(above)].parent;
    return above;
  }

  void choose() {
    for (const SceneSkin& skin : scene_.skins)
      for (const SceneBone& bone : skin.bones) chosen_[node_index(bone.node)] = true;
    std::vector<bool> bones = chosen_;
    for (const SceneTake& take : scene_.takes)
      for (const SceneTrack& track : take.tracks) {
        const std::size_t node = owner(node_index(track.node));
        const SceneNodeKind kind = scene_.nodes[node].kind;
        const bool moves = track.positions.times.size() > 1 || track.rotations.times.size() > 1 ||
                           track.scales.times.size() > 1;
        moved_[node] = moved_[node] || moves;
        if (kind == SceneNodeKind::plain || (kind == SceneNodeKind::mesh && moves))
          chosen_[node] = true;
      }
    bones_ = std::move(bones);
  }

  // The root: nodes above it stand still and lead to it alone.
  std::size_t top_of(const std::vector<bool>& inside) const {
    std::vector<std::size_t> children(inside.size(), 0), last(inside.size(), 0);
    for (std::size_t i = 1; i < inside.size(); ++i)
      if (inside[i]) {
        ++children[node_index(scene_.nodes[i].parent)];
        last[node_index(scene_.nodes[i].parent)] = i;
      }
    std::size_t top = 0;
    while (children[top] == 1 && (helper(top) || (!moved_[top] && !bones_[top]))) top = last[top];
    return top;
  }

  void rest() {
    const Places nodes = scene_places(scene_);
    Places bound(nodes.size());
    std::vector<bool> known(nodes.size(), false);
    std::vector<std::size_t> order(scene_.skins.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return scene_.skins[a].bones.size() > scene_.skins[b].bones.size();
    });
    for (const std::size_t i : order) {
      const BindPose pose(scene_.skins[i], nodes);
      if (!pose.usable()) continue;
      const bool differs = pose.differs();
      pose.each([&](int node, const Eigen::Matrix4d& place) {
        if (known[node_index(node)]) return;
        known[node_index(node)] = true;
        bound[node_index(node)] = differs ? place : nodes[node_index(node)];
        skeleton_.bound = skeleton_.bound || differs;
      });
    }
    if (!skeleton_.bound) {
      skeleton_.rest = nodes;
      return;
    }
    skeleton_.rest.resize(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const SceneNode& node = scene_.nodes[i];
      skeleton_.rest[i] = known[i]          ? bound[i]
                          : node.parent < 0 ? node.local
                                            : skeleton_.rest[node_index(node.parent)] * node.local;
    }
  }

  // What hangs on the last joints and is no joint, mesh, camera or light.
  void end_sites(const std::vector<bool>& inside, const std::vector<int>& joint) {
    std::vector<bool> last(skeleton_.joints.size(), true);
    for (const SceneJoint& child : skeleton_.joints)
      if (child.parent >= 0) last[node_index(child.parent)] = false;
    for (std::size_t i = 1; i < inside.size(); ++i) {
      const SceneNode& node = scene_.nodes[i];
      const int above = node_above(i), parent = above < 0 ? -1 : joint[node_index(above)];
      if (inside[i] || parent < 0 || !last[node_index(parent)] || node.kind != SceneNodeKind::plain)
        continue;
      const Eigen::Vector3d bone =
          (skeleton_.rest[i] - skeleton_.rest[node_index(above)]).topRightCorner<3, 1>();
      if (bone.norm() > 0) skeleton_.joints[node_index(parent)].end_sites.push_back(bone);
    }
  }

  const Scene& scene_;
  const std::string& file_;
  std::vector<bool> chosen_, moved_, bones_;
  SceneSkeleton skeleton_;
};

}  // namespace

std::vector<Eigen::Matrix4d> scene_places(const Scene& scene) {
  Places places;
  for (const SceneNode& node : scene.nodes)
    places.push_back(node.parent < 0
                         ? node.local
                         : Eigen::Matrix4d(places[node_index(node.parent)] * node.local));
  return places;
}

SceneSkeleton scene_skeleton(const Scene& scene, const std::string& file) {
  return SkeletonFinder(scene, file).find();
}

}  // namespace mocaplm
