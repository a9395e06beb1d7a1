#include <algorithm>

#include "common/error.h"
#include "common/json.h"
#include "common/text.h"
#include "motion/formats/retarget_map.h"

namespace mocaplm {

namespace {

const std::vector<std::string> kAxisNames = {"+x", "-x", "+y", "-y", "+z", "-z"};

// An axis of the T-pose: "+x" or three numbers, made unit length.
Eigen::Vector3d direction(const Json& json, const JsonObject& object, const std::string& key) {
  if (json.is_string()) {
    const std::string name = json.get<std::string>();
    if (std::find(kAxisNames.begin(), kAxisNames.end(), name) != kAxisNames.end())
      return (name[0] == '-' ? -1 : 1) * Eigen::Vector3d::Unit(name[1] - 'x');
  } else if (json.is_array() && json.size() == 3 && json[0].is_number() && json[1].is_number() &&
             json[2].is_number()) {
    const Eigen::Vector3d v(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
    if (v.allFinite() && v.norm() > 1e-3 && v.norm() < 1e3) return v.normalized();
  }
  object.fail(key, "must hold directions: \"+x\" ... \"-z\" or [x, y, z]");
}

void read_joints(RetargetMap& map, JsonObject& object) {
  for (const std::string& key : object.keys()) {
    const int joint = joint_index(key);
    const std::vector<std::string> names(joint_names().begin(), joint_names().end());
    if (joint < 0) object.fail(key, "is no SMPL joint" + did_you_mean(key, names));
    map.joints[static_cast<std::size_t>(joint)] = object.text(key);
  }
  object.finish();
}

void read_axes(RetargetMap& map, JsonObject& object) {
  map.t_pose = TPose::axes;
  for (const std::string& key : object.keys()) {
    const Json& pair = object.raw(key);
    if (!pair.is_array() || pair.size() != 2) object.fail(key, "must be [x axis, y axis]");
    const JointAxes axes{direction(pair[0], object, key), direction(pair[1], object, key)};
    if (std::abs(axes.x.dot(axes.y)) > 1e-3)
      object.fail(key, "must be two directions at right angles");
    map.axes[key] = {axes.x, (axes.y - axes.x.dot(axes.y) * axes.x).normalized()};
  }
  object.finish();
}

void read_euler(RetargetMap& map, JsonObject& object) {
  map.t_pose = TPose::euler;
  for (const std::string& key : object.keys()) map.euler[key] = object.numbers(key);
  object.finish();
}

void read_t_pose(RetargetMap& map, JsonObject& object) {
  const std::vector<std::string> kinds = object.keys();
  if (kinds.size() > 1)
    object.fail(kinds[1], "stands beside \"" + kinds[0] +
                              "\": a T-pose comes from one of axes, euler, frame");
  if (object.has("axes")) {
    JsonObject axes = object.object("axes");
    read_axes(map, axes);
  } else if (object.has("euler")) {
    JsonObject euler = object.object("euler");
    read_euler(map, euler);
  } else if (object.has("frame")) {
    map.t_pose = TPose::frame;
    map.frame = object.integer("frame", 0, 1000000);
  }
  object.finish();
}

}  // namespace

std::string map_text(const RetargetMap& map) {
  Json joints = Json::object();
  for (std::size_t j = 0; j < kJoints; ++j)
    if (!map.joints[j].empty()) joints[joint_names()[j]] = map.joints[j];
  return Json{{"joints", joints}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

RetargetMap load_map(const std::filesystem::path& path) {
  JsonObject object(load_json(path), path.string());
  RetargetMap map;
  map.scheme = path.string();
  JsonObject joints = object.object("joints");
  read_joints(map, joints);
  if (object.has("t_pose")) {
    JsonObject t_pose = object.object("t_pose");
    read_t_pose(map, t_pose);
  }
  if (object.has("up")) map.up = object.choice("up", kAxisNames);
  if (object.has("facing")) map.facing = object.choice("facing", kAxisNames);
  if (object.has("unit")) map.unit = object.number("unit", 1e-6, 1e6);
  if (object.has("align")) map.align = object.boolean("align");
  object.finish();
  for (const int j : required_joints())
    if (map.joints[static_cast<std::size_t>(j)].empty())
      joints.fail(joint_names()[static_cast<std::size_t>(j)],
                  "is missing: which joint of the file is it?");
  return map;
}

}  // namespace mocaplm
