// Skeletons of one's own for the retargeting tests: the same SMPL pose written as a .bvh in the
// conventions of each naming scheme. Built from the definition (joint positions and axes in the
// T-pose), with nothing of motion/formats/retarget*.
#pragma once

#include <Eigen/Geometry>
#include <sstream>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm {

struct RigJoint {
  std::string name, parent;
  int role;                                            // the SMPL joint with which it turns
  Eigen::Vector3d position;                            // in the T-pose, metres, our world
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // its own axes in the T-pose
};

struct Rig {
  std::vector<RigJoint> joints;  // parents first
  double unit = 0.01;            // metres per unit of the file
  std::string order = "ZXY";
  // From our world into the file's.
  Eigen::Matrix3d world = Eigen::Matrix3d::Identity();

  int index(const std::string& name) const {
    for (std::size_t i = 0; i < joints.size(); ++i)
      if (joints[i].name == name) return static_cast<int>(i);
    return -1;
  }
  const RigJoint* parent(const RigJoint& joint) const {
    const int i = index(joint.parent);
    return i < 0 ? nullptr : &joints[static_cast<std::size_t>(i)];
  }

  // World rotation of a joint in our world when SMPL's joints are turned by `world_rotations`.
  static Eigen::Matrix3d rotation(const RigJoint& joint,
                                  const std::array<Eigen::Matrix3d, kJoints>& turned) {
    return turned[static_cast<std::size_t>(joint.role)] * joint.axes;
  }
  // Positions of all joints, our world, metres: each bone turns with the parent's role.
  std::vector<Eigen::Vector3d> positions(const std::array<Eigen::Matrix3d, kJoints>& turned,
                                         const Eigen::Vector3d& root) const {
    std::vector<Eigen::Vector3d> all;
    for (const RigJoint& joint : joints) {
      const RigJoint* p = parent(joint);
      all.push_back(!p ? root
                       : Eigen::Vector3d(all[static_cast<std::size_t>(index(joint.parent))] +
                                         turned[static_cast<std::size_t>(p->role)] *
                                             (joint.position - p->position)));
    }
    return all;
  }

  void write_joint(std::ostream& out, const RigJoint& joint) const {
    const RigJoint* p = parent(joint);
    // The bone in the parent's own axes, which is what an OFFSET is.
    const Eigen::Vector3d bone =
        p ? Eigen::Vector3d(p->axes.transpose() * (joint.position - p->position) / unit)
          : Eigen::Vector3d(Eigen::Vector3d::Zero());
    out << (p ? "JOINT " : "ROOT ") << joint.name << "\n{\nOFFSET " << bone.x() << " " << bone.y()
        << " " << bone.z() << "\nCHANNELS " << (p ? "3" : "6 Xposition Yposition Zposition");
    for (const char axis : order) out << " " << axis << "rotation";
    out << "\n";
    bool leaf = true;
    for (const RigJoint& child : joints)
      if (child.parent == joint.name) {
        write_joint(out, child);
        leaf = false;
      }
    if (leaf) out << "End Site\n{\nOFFSET 0 0 0\n}\n";
    out << "}\n";
  }
  void write_values(std::ostream& out, const RigJoint& joint,
                    const std::array<Eigen::Matrix3d, kJoints>& turned) const {
    const RigJoint* p = parent(joint);
    const Eigen::Matrix3d above = p ? rotation(*p, turned) : world.transpose();
    const EulerOrder euler = {order[0] - 'X', order[1] - 'X', order[2] - 'X'};
    const Eigen::Vector3d angles =
        euler_from_matrix(above.transpose() * rotation(joint, turned), euler);
    out << " " << angles.transpose() * (180 / 3.14159265358979323846);
    for (const RigJoint& child : joints)
      if (child.parent == joint.name) write_values(out, child, turned);
  }

  // The clip's rotations as this rig's .bvh; the root joint is put at `roots` (frames, 3), metres.
  std::string bvh(const Clip& clip, const Translations& roots) const {
    std::ostringstream out;
    out.precision(12);
    out << "HIERARCHY\n";
    write_joint(out, joints.front());
    out << "MOTION\nFrames: " << clip.frames() << "\nFrame Time: 0.0333333\n";
    for (Eigen::Index t = 0; t < clip.frames(); ++t) {
      const auto turned = joint_world_rotations(clip, t);
      const Eigen::Vector3d root = world * roots.row(t).transpose() / unit;
      out << root.x() << " " << root.y() << " " << root.z();
      write_values(out, joints.front(), turned);
      out << "\n";
    }
    return out.str();
  }
};

// Axes by two directions.
inline Eigen::Matrix3d axes(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
  Eigen::Matrix3d m;
  m << x, y, x.cross(y);
  return m;
}

}  // namespace mocaplm
