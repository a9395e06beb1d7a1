// The naming schemes that need no map file, and how one is recognised.
#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/retarget_map.h"

namespace mocaplm {

namespace {

// Joint names without prefix, case and separators; "S" stands for the side, "|" parts alternatives.
struct Scheme {
  const char* name;
  const char* left;
  const char* right;
  const char *pelvis, *spine1, *spine2, *spine3, *neck, *head;
  const char *hip, *knee, *ankle, *foot, *collar, *shoulder, *elbow, *wrist, *hand;
};

// Where two match equally many joints the earlier one is taken. Two spine joints are SMPL's spine2
// and spine3, as data sets that were converted before have it; spine1 then lies half way to the
// pelvis.
const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> all = {
      {"smpl", "left", "right", "pelvis", "spine1", "spine2", "spine3", "neck", "head", "Ship",
       "Sknee", "Sankle", "Sfoot", "Scollar", "Sshoulder", "Selbow", "Swrist", "Shand"},
      {"smpl", "l", "r", "pelvis", "spine1", "spine2", "spine3", "neck", "head", "Ship", "Sknee",
       "Sankle", "Sfoot", "Scollar", "Sshoulder", "Selbow", "Swrist", "Shand"},
      {"cmu-daz", "l", "r", "hip", "", "abdomen", "chest", "neck", "head", "Sthigh", "Sshin",
       "Sfoot", "", "Scollar", "Sshldr", "Sforearm", "Shand", "Smid1"},
      {"bandai-namco", "l", "r", "hips", "", "spine", "chest", "neck", "head", "upperlegS",
       "lowerlegS", "footS", "toesS", "shoulderS", "upperarmS", "lowerarmS", "handS", ""},
      {"motionbuilder", "left", "right", "hips", "", "spine", "spine1", "neck", "head", "Supleg",
       "Sleg", "Sfoot", "Stoebase|Stoe", "Sshoulder", "Sarm", "Sforearm", "Shand", "Shandmiddle1"},
      {"cmu", "left", "right", "hips", "lowerback", "spine", "spine1", "neck", "head", "Supleg",
       "Sleg", "Sfoot", "Stoebase|Stoe", "Sshoulder", "Sarm", "Sforearm", "Shand", "Sfingerbase"},
      {"mixamo", "left", "right", "hips", "spine", "spine2", "spine3", "neck", "head", "Supleg",
       "Sleg", "Sfoot", "Stoebase|Stoe", "Sshoulder", "Sarm", "Sforearm", "Shand", "Shandmiddle1"},
      {"mixamo", "left", "right", "hips", "spine", "spine1", "spine2", "neck", "head", "Supleg",
       "Sleg", "Sfoot", "Stoebase|Stoe", "Sshoulder", "Sarm", "Sforearm", "Shand", "Shandmiddle1"},
      {"classic", "left", "right", "hips", "", "", "chest", "neck", "head", "Ship", "Sknee",
       "Sankle", "Stoe", "Scollar", "Sshoulder", "Selbow", "Swrist", ""},
      {"classic", "left", "right", "hips", "", "chest", "chest2", "neck", "head", "Ship", "Sknee",
       "Sankle", "Stoe", "Scollar", "Sshoulder", "Selbow", "Swrist", ""},
      {"classic", "left", "right", "hips", "chest", "chest2", "chest4|chest3", "neck", "head",
       "Ship", "Sknee", "Sankle", "Stoe", "Scollar", "Sshoulder", "Selbow", "Swrist", ""}};
  return all;
}

std::string simple(std::string name) {
  const std::size_t colon = name.rfind(':');
  if (colon != name.npos) name.erase(0, colon + 1);
  name = lower(name);
  name.erase(std::remove_if(name.begin(), name.end(),
                            [](char c) { return c == '_' || c == ' ' || c == '-' || c == '.'; }),
             name.end());
  return name;
}

// Simple name -> joint. A prefix up to an underscore that all joints share ("Model_Hips") is
// dropped.
std::map<std::string, std::string> simple_names(const Bvh& bvh) {
  const std::string& root = bvh.joints.front().name;
  std::string prefix = root.substr(0, root.find('_') + 1);  // npos + 1 = 0: none
  for (const BvhJoint& joint : bvh.joints)
    if (joint.name.compare(0, prefix.size(), prefix) != 0) prefix.clear();
  std::map<std::string, std::string> names;
  for (const BvhJoint& joint : bvh.joints)
    names.emplace(simple(joint.name.substr(prefix.size())), joint.name);
  return names;
}

std::string with_side(const std::string& pattern, const char* side) {
  const std::size_t at = pattern.find('S');
  return at == pattern.npos ? pattern : pattern.substr(0, at) + side + pattern.substr(at + 1);
}

// What the scheme calls each SMPL joint, alternatives parted by "|".
std::array<std::string, kJoints> wanted(const Scheme& s) {
  const std::array<const char*, kJoints> patterns = {
      s.pelvis,   s.hip,      s.hip,   s.spine1, s.knee,  s.knee,   s.spine2, s.ankle,
      s.ankle,    s.spine3,   s.foot,  s.foot,   s.neck,  s.collar, s.collar, s.head,
      s.shoulder, s.shoulder, s.elbow, s.elbow,  s.wrist, s.wrist,  s.hand,   s.hand};
  std::array<std::string, kJoints> names;
  for (std::size_t j = 0; j < kJoints; ++j) {
    std::vector<std::string> alternatives = split(patterns[j], '|');
    for (std::string& name : alternatives)
      name = with_side(name, joint_names()[j].compare(0, 4, "left") == 0 ? s.left : s.right);
    names[j] = join(alternatives, "|");
  }
  return names;
}

RetargetMap match(const Scheme& scheme, const std::map<std::string, std::string>& names) {
  RetargetMap map;
  map.scheme = scheme.name;
  const auto names_wanted = wanted(scheme);
  for (std::size_t j = 0; j < kJoints; ++j)
    for (const std::string& name : split(names_wanted[j], '|')) {
      const auto found = names.find(name);
      if (name.empty() || found == names.end() || !map.joints[j].empty()) continue;
      map.joints[j] = found->second;
    }
  return map;
}

std::size_t matched(const RetargetMap& map) {
  return static_cast<std::size_t>(std::count_if(
      map.joints.begin(), map.joints.end(), [](const std::string& name) { return !name.empty(); }));
}

std::vector<std::string> missing(const RetargetMap& map) {
  std::vector<std::string> names;
  for (const int j : required_joints())
    if (map.joints[static_cast<std::size_t>(j)].empty())
      names.push_back(joint_names()[static_cast<std::size_t>(j)]);
  return names;
}

// How the axes of each kind of joint lie in a T-pose.
struct AxesTable {
  JointAxes pelvis, spine, left_arm, right_arm, left_leg, right_leg, left_ankle, right_ankle,
      left_foot, right_foot;

  const JointAxes& of(int joint) const {
    const std::string& name = joint_names()[static_cast<std::size_t>(joint)];
    const bool left = name.compare(0, 4, "left") == 0;
    const auto ends = [&](const char* part) { return name.find(part) != name.npos; };
    if (joint == 0) return pelvis;
    if (mirrored_joints()[static_cast<std::size_t>(joint)] == joint) return spine;
    if (ends("hip") || ends("knee")) return left ? left_leg : right_leg;
    if (ends("ankle")) return left ? left_ankle : right_ankle;
    if (ends("foot")) return left ? left_foot : right_foot;
    return left ? left_arm : right_arm;
  }
};

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(),
                      kZ = Eigen::Vector3d::UnitZ();

// A direction `degrees` below forward: a foot.
Eigen::Vector3d below_forward(double degrees) {
  const double angle = degrees * 3.14159265358979323846 / 180;
  return std::cos(angle) * kZ - std::sin(angle) * kY;
}

// Bandai-Namco Research Motiondataset 1 and 2: bones lie along +x on the left and along -x on the
// right.
AxesTable bandai_axes() {
  const Eigen::Vector3d ankle = below_forward(39.59), toes = below_forward(23.01);
  return {{kY, -kX}, {kY, kZ},    {kX, kY},     {kX, -kY},  {-kY, kX},
          {kY, kX},  {ankle, kX}, {-ankle, kX}, {toes, kX}, {-toes, kX}};
}

// LAFAN1: every bone lies along +x. Feet from the data's standing frames: flat feet have the bone
// from ankle to toes 25.5 degrees below the horizontal and the toe joint's own x 4.5 degrees below
// it.
AxesTable lafan_axes() {
  const auto foot = [](double degrees) {
    return JointAxes{below_forward(degrees), below_forward(degrees - 90)};
  };
  return {{kY, kZ},  {kY, kZ},   {kX, -kZ},  {-kX, -kZ}, {-kY, kZ},
          {-kY, kZ}, foot(25.5), foot(25.5), foot(4.5),  foot(4.5)};
}

void set_axes(RetargetMap& map, const AxesTable& table) {
  map.t_pose = TPose::axes;
  for (int j = 0; j < kJoints; ++j) {
    const std::string& name = map.joints[static_cast<std::size_t>(j)];
    if (!name.empty()) map.axes[name] = table.of(j);
  }
}

// True when every limb's zero-pose bone leaves its joint along +x, as in LAFAN1.
bool bones_along_x(const Bvh& bvh, const RetargetMap& map) {
  for (const int j : {4, 5, 7, 8, 18, 19, 20, 21}) {
    const int joint = bvh.joint(map.joints[static_cast<std::size_t>(j)]);
    const Eigen::Vector3d& offset = bvh.joints[static_cast<std::size_t>(joint)].offset;
    if (offset.x() < 0.9 * offset.norm()) return false;
  }
  return true;
}

[[noreturn]] void fail_unknown(const Bvh& bvh, const RetargetMap& best, const std::string& file) {
  std::vector<std::string> names;
  for (const BvhJoint& joint : bvh.joints) {
    if (names.size() == 80) break;
    names.push_back(joint.name.substr(0, 60));
  }
  if (bvh.joints.size() > names.size()) names.push_back("...");
  throw DataError(in_file(file),
                  "the joints are named by no scheme that is known (nearest: " + best.scheme +
                      ", without a match for " + join(missing(best), ", ") +
                      "). Give a map that names them, see docs/bvh-maps.md. Joints in the file: " +
                      join(names, ", "));
}

}  // namespace

const std::vector<int>& required_joints() {
  static const std::vector<int> joints = {0, 1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21};
  return joints;
}

RetargetMap detect_map(const Bvh& bvh, const std::string& file) {
  const auto names = simple_names(bvh);
  RetargetMap best;
  std::size_t best_score = 0;
  for (const Scheme& scheme : schemes()) {
    const RetargetMap map = match(scheme, names);
    // A scheme with all the joints it needs goes before any without.
    const std::size_t score = 1 + matched(map) + (missing(map).empty() ? 100 : 0);
    if (score > best_score) best = map;
    best_score = std::max(best_score, score);
  }
  if (!missing(best).empty()) fail_unknown(bvh, best, file);
  best.align = best.scheme != "smpl";  // SMPL's own rotations are taken as they are
  if (zero_pose_stands(bvh, best)) return best;
  if (best.scheme == "bandai-namco") {
    set_axes(best, bandai_axes());
  } else if (bones_along_x(bvh, best) && best.scheme == "mixamo") {
    best.scheme = "lafan";
    set_axes(best, lafan_axes());
  } else {
    throw DataError(in_file(file),
                    "has the joint names of " + best.scheme +
                        ", but with all rotations zero the figure does not stand upright with its "
                        "legs below its hips. Give a map that says how a T-pose is got, see "
                        "docs/bvh-maps.md");
  }
  return best;
}

}  // namespace mocaplm
