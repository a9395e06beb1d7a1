// The naming schemes that need no map file, and what is done about other names.
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/recognise.h"
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
  for (const int j : {0, 1, 2, 4, 5, 7, 8, 16, 17, 18, 19, 20, 21})
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
  const double angle = degrees * kPi / 180;
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

// `written`: the map file with the best guess; empty: none was asked for.
[[noreturn]] void fail_unknown(const Bvh& bvh, const std::string& doubt, const std::string& file,
                               const std::string& written) {
  std::vector<std::string> names;
  for (const BvhJoint& joint : bvh.joints) {
    if (names.size() == 80) break;
    names.push_back(joint.name.substr(0, 60));
  }
  if (bvh.joints.size() > names.size()) names.push_back("...");
  throw DataError(
      in_file(file),
      "is no figure that is recognised for certain: " + doubt +
          (written.empty() ? ". --write-map map.json writes the best guess; correct it "
                             "and give it back with --bvh-map map.json"
                           : ". The best guess is in " + written +
                                 "; correct it and give it back with --bvh-map " + written) +
          " (docs/bvh-maps.md). Joints in the file: " + join(names, ", "));
}

// Whether the bones lie as SMPL's do in its rest pose, so that its own rotations can be taken.
bool smpl_bones(const Bvh& bvh, const RetargetMap& map) {
  const BvhPose zero = rest_bvh(bvh);
  for (int j = 1; j < kJoints; ++j) {
    const std::string& name = map.joints[static_cast<std::size_t>(j)];
    const int parent = joint_parents()[static_cast<std::size_t>(j)];
    const std::string& above = map.joints[static_cast<std::size_t>(parent)];
    if (name.empty() || above.empty()) continue;
    const Eigen::Vector3d bone = zero.positions[static_cast<std::size_t>(bvh.joint(name))] -
                                 zero.positions[static_cast<std::size_t>(bvh.joint(above))];
    const Eigen::Vector3d ours = (rest_joints().row(j) - rest_joints().row(parent)).transpose();
    if (bone.normalized().dot(ours.normalized()) < 0.9986) return false;  // 3 degrees
  }
  return true;
}

// The spine's joints as recognise_body has them, where a scheme's chest is not what the arms hang
// from: the file has more joints than the scheme, or other ones.
void mend_spine(const Bvh& bvh, RetargetMap& map) {
  const auto joint = [&](int smpl) {
    return bvh.joint(map.joints[static_cast<std::size_t>(smpl)]);
  };
  const int left = map.joints[13].empty() ? 16 : 13;
  const int trunk = common_ancestor(bvh, joint(left), joint(left + 1));
  map.scheme_spine = true;
  if (!map.joints[9].empty() && joint(9) == trunk) return;
  const Recognised found = recognise_body(bvh);
  if (!found.doubt.empty()) return;
  map.scheme_spine = false;
  for (const int smpl : {3, 6, 9, 12})
    map.joints[static_cast<std::size_t>(smpl)] =
        found.joints[static_cast<std::size_t>(smpl)] < 0
            ? ""
            : bvh.joints[static_cast<std::size_t>(found.joints[static_cast<std::size_t>(smpl)])]
                  .name;
}

RetargetMap recognised_map(const Bvh& bvh, const Recognised& found) {
  RetargetMap map;
  map.scheme = "recognised";
  for (std::size_t j = 0; j < kJoints; ++j)
    if (found.joints[j] >= 0)
      map.joints[j] = bvh.joints[static_cast<std::size_t>(found.joints[j])].name;
  return map;
}

void write_once(const RetargetMap& map, const std::string& path) {
  std::error_code unknown;
  if (!path.empty() && !std::filesystem::exists(path, unknown)) write_file(path, map_text(map));
}

}  // namespace

const std::vector<int>& required_joints() {
  static const std::vector<int> joints = {0, 1, 2, 4, 5, 16, 17, 18, 19};
  return joints;
}

RetargetMap detect_map(const Bvh& bvh, const std::string& file, const std::string& write_to) {
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
  if (!missing(best).empty()) {
    const Recognised found = recognise_body(bvh);
    best = recognised_map(bvh, found);
    write_once(best, write_to);
    if (!found.doubt.empty()) fail_unknown(bvh, found.doubt, file, write_to);
    return best;
  }
  mend_spine(bvh, best);
  // SMPL's own rotations are taken as they are.
  best.align = best.scheme != "smpl" || !smpl_bones(bvh, best);
  if (best.scheme == "bandai-namco") {
    set_axes(best, bandai_axes());
  } else if (best.scheme == "mixamo" && bones_along_x(bvh, best)) {
    set_axes(best, lafan_axes());
  }
  write_once(best, write_to);
  return best;
}

}  // namespace mocaplm
