// An ASCII .fbx (7.3) of bones that turn by Euler angles, with what makes such files hard: a turn
// before and after the animated one, orders of rotation, units and axes. Written from the format's
// description (Autodesk FBX SDK, "Computing transformation matrices").
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace mocaplm {

struct FbxBone {
  std::string name;
  int parent = -1;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), rotation = Eigen::Vector3d::Zero(),
                  scaling = Eigen::Vector3d::Ones();  // where nothing moves it
  Eigen::Vector3d pre = Eigen::Vector3d::Zero(), post = Eigen::Vector3d::Zero();  // degrees, XYZ
  int order = 0;  // 0 XYZ, 1 XZY, 2 YZX, 3 YXZ, 4 ZXY, 5 ZYX: the first is applied first
  std::vector<Eigen::Vector3d> translations, rotations;  // by frame; empty: do not move
};

// World = parent * T * Rpre * R * Rpost^-1 * S, column vectors.
inline Eigen::Matrix3d fbx_rotation(const Eigen::Vector3d& degrees, int order) {
  static const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (const int axis : axes[order])
    turn =
        Eigen::AngleAxisd(degrees[axis] * 3.14159265358979323846 / 180, Eigen::Vector3d::Unit(axis))
            .toRotationMatrix() *
        turn;
  return turn;
}

inline std::vector<Eigen::Matrix4d> fbx_places(const std::vector<FbxBone>& bones, int frame) {
  std::vector<Eigen::Matrix4d> world;
  for (const FbxBone& bone : bones) {
    const auto at = static_cast<std::size_t>(std::max(frame, 0));
    const bool turns = frame >= 0 && !bone.rotations.empty();
    const bool shifts = frame >= 0 && !bone.translations.empty();
    Eigen::Matrix4d own = Eigen::Matrix4d::Identity();
    own.topLeftCorner<3, 3>() =
        fbx_rotation(bone.pre, 0) *
        fbx_rotation(turns ? bone.rotations[at] : bone.rotation, bone.order) *
        fbx_rotation(bone.post, 0).transpose() * bone.scaling.asDiagonal();
    own.topRightCorner<3, 1>() = shifts ? bone.translations[at] : bone.translation;
    world.push_back(bone.parent < 0
                        ? own
                        : Eigen::Matrix4d(world[static_cast<std::size_t>(bone.parent)] * own));
  }
  return world;
}

struct FbxSettings {
  double unit = 1;  // centimetres
  bool z_up = false;
  std::string take = "Take 001";
  double fps = 30;
};

class FbxText {
 public:
  FbxText(const std::vector<FbxBone>& bones, const FbxSettings& settings)
      : bones_(bones), settings_(settings) {}

  std::string text() {
    out_.precision(17);
    out_ << "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n"
            "\tFBXVersion: 7300\n}\n";
    const bool z = settings_.z_up;
    out_ << "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n";
    for (const auto& [key, value] :
         std::vector<std::pair<const char*, int>>{{"UpAxis", z ? 2 : 1},
                                                  {"UpAxisSign", 1},
                                                  {"FrontAxis", z ? 1 : 2},
                                                  {"FrontAxisSign", z ? -1 : 1},
                                                  {"CoordAxis", 0},
                                                  {"CoordAxisSign", 1}})
      out_ << "\t\tP: \"" << key << "\", \"int\", \"Integer\", \"\"," << value << "\n";
    out_ << "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," << settings_.unit
         << "\n\t}\n}\nObjects:  {\n";
    for (std::size_t i = 0; i < bones_.size(); ++i) model(i);
    out_ << "\tAnimationStack: 900, \"AnimStack::" << settings_.take
         << "\", \"\" {\n\t}\n\tAnimationLayer: 901, \"AnimLayer::Base\", \"\" {\n\t}\n";
    links_ << "\tC: \"OO\",901,900\n";
    for (std::size_t i = 0; i < bones_.size(); ++i) {
      if (!bones_[i].translations.empty())
        curves(i, 0, "T", "Lcl Translation", bones_[i].translations);
      if (!bones_[i].rotations.empty()) curves(i, 1, "R", "Lcl Rotation", bones_[i].rotations);
    }
    out_ << "}\nConnections:  {\n" << links_.str() << "}\n";
    return out_.str();
  }

 private:
  static std::size_t id(std::size_t bone) { return 1000 + 20 * bone; }

  void property(const char* key, const char* type, const Eigen::Vector3d& v) {
    out_ << "\t\t\tP: \"" << key << "\", \"" << type << "\", \"\", \"A\"," << v.x() << "," << v.y()
         << "," << v.z() << "\n";
  }
  void model(std::size_t i) {
    const FbxBone& bone = bones_[i];
    out_ << "\tModel: " << id(i) << ", \"Model::" << bone.name
         << "\", \"LimbNode\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n";
    out_ << "\t\t\tP: \"RotationOrder\", \"enum\", \"\", \"\"," << bone.order << "\n"
         << "\t\t\tP: \"RotationActive\", \"bool\", \"\", \"\",1\n";
    property("PreRotation", "Vector3D", bone.pre);
    property("PostRotation", "Vector3D", bone.post);
    property("Lcl Translation", "Lcl Translation", bone.translation);
    property("Lcl Rotation", "Lcl Rotation", bone.rotation);
    property("Lcl Scaling", "Lcl Scaling", bone.scaling);
    out_ << "\t\t}\n\t}\n";
    links_ << "\tC: \"OO\"," << id(i) << ","
           << (bone.parent < 0 ? 0 : id(static_cast<std::size_t>(bone.parent))) << "\n";
  }
  void curves(std::size_t i, std::size_t kind, const char* name, const char* property,
              const std::vector<Eigen::Vector3d>& values) {
    const std::size_t node = id(i) + 1 + 4 * kind;
    out_ << "\tAnimationCurveNode: " << node << ", \"AnimCurveNode::" << name
         << "\", \"\" {\n\t}\n";
    links_ << "\tC: \"OO\"," << node << ",901\n\tC: \"OP\"," << node << "," << id(i) << ", \""
           << property << "\"\n";
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t curve = node + 1 + static_cast<std::size_t>(axis);
      out_ << "\tAnimationCurve: " << curve << ", \"AnimCurve::\", \"\" {\n\t\tDefault: 0\n"
           << "\t\tKeyVer: 4008\n\t\tKeyTime: *" << values.size() << " {\n\t\t\ta: ";
      for (std::size_t t = 0; t < values.size(); ++t)
        out_ << (t ? "," : "")
             << static_cast<long long>(
                    std::llround(46186158000.0 * static_cast<double>(t) / settings_.fps));
      out_ << "\n\t\t}\n\t\tKeyValueFloat: *" << values.size() << " {\n\t\t\ta: ";
      for (std::size_t t = 0; t < values.size(); ++t) out_ << (t ? "," : "") << values[t][axis];
      out_ << "\n\t\t}\n\t}\n";
      links_ << "\tC: \"OP\"," << curve << "," << node << ", \"d|"
             << "XYZ"[axis] << "\"\n";
    }
  }

  const std::vector<FbxBone>& bones_;
  FbxSettings settings_;
  std::ostringstream out_, links_;
};

}  // namespace mocaplm
