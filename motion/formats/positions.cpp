#include "motion/formats/positions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/joint_vocabulary.h"
#include "motion/formats/npy.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr double kHumanMl3dRate = 20;
constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{1} << 28;

struct Layout {
  std::size_t first = 0;  // leading axes of length 1
  std::size_t frames = 0, joints = 0;
  bool flat = false;  // (frames, 3 * joints)
};

// What arrays of other numbers of joints are, for messages.
std::string joints_of(std::size_t joints) {
  static const std::map<std::size_t, const char*> known = {
      {14, "LSP"},
      {15, "OpenPose's MPI or KTH"},
      {16, "MPII or Human3.6M without its nose"},
      {17, "Human3.6M or COCO"},
      {18, "OpenPose's COCO"},
      {19, "Panoptic"},
      {20, "Kinect's first"},
      {21, "KIT-ML, or a hand"},
      {23, "SMPL's without the pelvis, or DeepLabCut's"},
      {25, "OpenPose's BODY_25 or Kinect's (NTU RGB+D)"},
      {26, "HALPE"},
      {28, "MPI-INF-3DHP"},
      {31, "CMU"},
      {32, "Human3.6M's 32"},
      {33, "MediaPipe"},
      {42, "two hands"},
      {133, "COCO-WholeBody"},
      {137, "OpenPose with hands and face"}};
  const auto found = known.find(joints);
  return found == known.end() ? "" : std::string(" (") + found->second + "?)";
}

bool is_smpl_like(std::size_t joints) {
  for (const std::size_t known : {22, 24, 45, 52, 55, 73, 127, 144})
    if (joints == known) return true;
  return false;
}

Layout layout_of(const NumpyArray& array) {
  Layout layout;
  const auto& shape = array.shape;
  while (shape.size() - layout.first > 2 && shape[layout.first] == 1 &&
         (shape.size() - layout.first > 3 || shape.back() != 3))
    ++layout.first;
  const std::size_t left = shape.size() - layout.first;
  if (left == 3 && shape.back() == 3) {
    layout.frames = shape[layout.first];
    layout.joints = shape[layout.first + 1];
  } else if (left == 2 && shape.back() % 3 == 0) {
    layout.frames = shape[layout.first];
    layout.joints = shape.back() / 3;
    layout.flat = true;
  }
  return layout;
}

bool is_known(const Layout& layout) {
  return layout.flat ? layout.joints == 22 || layout.joints == 24 : is_smpl_like(layout.joints);
}

[[noreturn]] void refuse(const NumpyArray& array, const Layout& layout, const Place& place) {
  const std::string shape = "has the shape " + shape_text(array);
  const std::string wanted =
      "; expected (frames, 22, 3) or (frames, 24, 3), SMPL's joints in SMPL's order";
  const std::size_t width = array.shape.empty() ? 0 : array.shape.back();
  if (array.dimensions() >= 2) {
    if (width == 263)
      throw DataError(place, shape +
                                 ": HumanML3D's features (new_joint_vecs), not positions; give "
                                 "the positions beside them (new_joints), or what "
                                 "recover_from_ric makes of them");
    if (width == 251)
      throw DataError(place, shape +
                                 ": KIT-ML's features (new_joint_vecs), not positions; give "
                                 "SMPL's joints, or what the file was made from");
  }
  if (layout.joints > 0 && !layout.flat)
    throw DataError(place, shape + ": " + std::to_string(layout.joints) + " joints" +
                               joints_of(layout.joints) + wanted +
                               ". Joints of another order come in with their names, as .csv or "
                               ".trc");
  if (array.dimensions() == 4 && array.shape[3] == 3)
    throw DataError(place, shape + ": several people or takes" + wanted + " of one");
  if (array.dimensions() == 4 && array.shape[2] == 3)
    throw DataError(place, shape + ": time last, as motion diffusion models keep it" + wanted);
  throw DataError(place, shape + ", which is none of positions of joints" + wanted);
}

// Element i of any shape in row-major order's counting, whatever the order in memory.
double element(const NumpyArray& flat, std::size_t frame, std::size_t joint, std::size_t axis,
               std::size_t joints, bool is_flat) {
  // As (frames, joints * 3); column-major (frames, joints, 3) has all joints' x first.
  const std::size_t column =
      flat.column_major && !is_flat ? joint + joints * axis : 3 * joint + axis;
  return flat.at(frame, column);
}

}  // namespace

bool is_position_array(const NumpyArray& array) {
  return array.type.is_number() && is_known(layout_of(array));
}

PositionTable table_of_array(const NumpyArray& array, const std::string& file,
                             const std::string& key) {
  const std::string where = key.empty() ? file : file + ": " + key;
  const Place place = in_file(where);
  const Layout layout = layout_of(array);
  if (!array.type.is_number()) throw DataError(place, "holds text, not positions");
  if (!is_known(layout)) refuse(array, layout, place);
  if (layout.frames == 0 || layout.frames > kMaxClipFrames)
    throw DataError(place, "has the shape " + shape_text(array) + ", expected 1 to " +
                               std::to_string(kMaxClipFrames) + " frames");
  PositionTable table;
  table.file = where;
  const std::size_t used = layout.joints == 24 || layout.joints == 45 ? 24 : 22;
  table.names.assign(joint_names().begin(),
                     joint_names().begin() + static_cast<std::ptrdiff_t>(used));
  NumpyArray flat = array;
  flat.shape = {layout.frames, 3 * layout.joints};
  table.places.resize(static_cast<Eigen::Index>(layout.frames),
                      static_cast<Eigen::Index>(3 * used));
  for (std::size_t t = 0; t < layout.frames; ++t)
    for (std::size_t j = 0; j < used; ++j)
      for (std::size_t c = 0; c < 3; ++c)
        table.places(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(3 * j + c)) =
            element(flat, t, j, c, layout.joints, layout.flat);
  if (layout.joints != used)
    table.remarks.push_back({"joints taken", "of " + std::to_string(layout.joints) +
                                                 " joints the first " + std::to_string(used) +
                                                 " are taken for SMPL's"});
  return table;
}

ReadMotion read_position_array(const NumpyArray& array, const std::string& name,
                               const std::string& file, const std::string& key,
                               std::optional<double> fps, const ReadOptions& options) {
  PositionTable table = table_of_array(array, file, key);
  table.fps = fps;
  table.by_custom_y_up = layout_of(array).joints == 22;
  if (!fps && !options.fps && layout_of(array).joints == 22) {
    table.fps = kHumanMl3dRate;
    table.remarks.push_back(
        {"frame rate", "20 frames per second are taken, HumanML3D's; the file says none"});
  }
  return motion_from_positions(std::move(table), name, options);
}

bool holds_positions(const fs::path& path) {
  constexpr std::uintmax_t kHeadBytes = 1 << 16;
  try {
    const std::string head = read_head(path, kHeadBytes);
    const std::string extension = lower(path.extension().string());
    if (extension == ".npy") return is_position_array(parse_npy_header(head, path.string()));
    if (extension == ".trc") return lower(head.substr(0, 12)) == "pathfiletype";
    if (extension != ".csv") return false;
    const std::string line = head.substr(0, head.find_first_of("\r\n"));
    return find_points(position_columns(line)).missing.empty();
  } catch (const Error&) {
    return false;
  }
}

std::vector<ReadMotion> read_positions_file(const fs::path& path, const ReadOptions& options) {
  const std::string file = path.string(), extension = lower(path.extension().string());
  // Every two bytes of a text may be a number of eight.
  const std::string name = path.stem().string(),
                    bytes = read_file(path, extension == ".npy" ? kMaxFileBytes : kMaxTextBytes);
  std::vector<ReadMotion> motions;
  if (extension == ".npy")
    motions.push_back(
        read_position_array(parse_npy(bytes, file), name, file, "", std::nullopt, options));
  else
    motions.push_back(motion_from_positions(
        extension == ".trc" ? read_trc(bytes, file) : read_position_csv(bytes, file), name,
        options));
  return motions;
}

}  // namespace mocaplm
