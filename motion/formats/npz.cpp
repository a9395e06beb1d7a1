#include "motion/formats/npz.h"

#include <cmath>
#include <vector>

#include "common/text.h"
#include "motion/formats/npy.h"
#include "motion/formats/zip_file.h"
#include "motion/rotation.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr std::size_t kBodyColumns = 66;

// An entry's bytes and the array that views them.
struct Entry {
  std::string bytes;
  NumpyArray array;
};

class AmassReader {
 public:
  explicit AmassReader(const fs::path& path) : file_(path.string()), zip_(path) {}

  bool has(const std::string& key) const { return zip_.has(key + ".npy"); }
  Place place(const std::string& key) const { return in_file(file_ + ": " + key + ".npy"); }
  // `entry` must stay where it is: its array points into its bytes.
  void read(const std::string& key, Entry& entry) const {
    entry.bytes = zip_.read(key + ".npy");
    entry.array = parse_npy(entry.bytes, place(key).file);
  }
  void read_motion(const std::string& key, std::size_t columns, Entry& entry) const {
    read(key, entry);
    check_motion_array(entry.array, key, columns, place(key));
  }
  std::string keys() const {
    std::vector<std::string> names = zip_.names();
    const std::size_t all = names.size();
    if (all > 20) names.resize(20);
    for (std::string& name : names)
      name = name.substr(0, std::min<std::size_t>(name.rfind(".npy"), 40));
    return names.empty() ? "nothing" : join(names, ", ") + (all > 20 ? ", ..." : "");
  }
  const std::string& file() const { return file_; }

 private:
  std::string file_;
  ZipReader zip_;
};

// Reads the rotations, and tells whether Z is up by what the layout says.
bool read_poses(const AmassReader& reader, UpAxis up, Clip& clip) {
  if (!reader.has("poses") && reader.has("root_orient") && reader.has("pose_body")) {
    Entry root, body;
    reader.read_motion("root_orient", 3, root);
    reader.read_motion("pose_body", 63, body);
    if (root.array.rows() != body.array.rows())
      throw DataError(reader.place("pose_body"), "has the shape " + shape_text(body.array) +
                                                     ", but root_orient " + shape_text(root.array));
    clip.poses = Poses::Zero(static_cast<Eigen::Index>(root.array.rows()), 72);
    copy_columns(root.array, 0, 3, clip.poses);
    copy_columns(body.array, 0, 63, clip.poses, 3);
    return true;
  }
  if (!reader.has("poses"))
    throw DataError(in_file(reader.file()),
                    "holds no motion: it has no poses, only " + reader.keys() +
                        ". AMASS's shape.npz files are like this; leave them out");
  Entry poses;
  reader.read_motion("poses", 0, poses);
  const std::size_t columns = poses.array.columns();
  if (columns != 72 && columns != 156 && columns != 165 && columns != kBodyColumns)
    throw DataError(reader.place("poses"),
                    "poses has the shape " + shape_text(poses.array) +
                        ", expected 72 (SMPL), 156 (SMPL+H), 165 (SMPL-X) or 66 (body) columns");
  if (columns == kBodyColumns && up == UpAxis::automatic)
    throw DataError(
        reader.place("poses"),
        "poses has 66 columns, a layout found with either axis up: say --up y or --up z");
  clip.poses = Poses::Zero(static_cast<Eigen::Index>(poses.array.rows()), 72);
  copy_columns(poses.array, 0, columns == 72 ? 72 : kBodyColumns, clip.poses);
  return columns != 72;
}

void read_trans(const AmassReader& reader, Clip& clip) {
  if (!reader.has("trans"))
    throw DataError(in_file(reader.file()),
                    "has no trans (root translation), only " + reader.keys());
  Entry trans;
  reader.read_motion("trans", 3, trans);
  if (trans.array.rows() != static_cast<std::size_t>(clip.frames()))
    throw DataError(reader.place("trans"), "trans has the shape " + shape_text(trans.array) +
                                               ", but there are " + std::to_string(clip.frames()) +
                                               " frames of poses");
  clip.trans.resize(clip.frames(), 3);
  copy_columns(trans.array, 0, 3, clip.trans);
}

double read_rate(const AmassReader& reader) {
  for (const std::string key : {"mocap_framerate", "mocap_frame_rate"}) {
    if (!reader.has(key)) continue;
    Entry entry;
    reader.read(key, entry);
    const double rate = single_number(entry.array, key, reader.place(key));
    const double whole = std::round(rate);
    // AMASS has rates such as 120.00004577636719.
    return whole > 0 && std::abs(rate - whole) < 1e-3 ? whole : rate;
  }
  throw DataError(
      in_file(reader.file()),
      "says no frame rate (mocap_framerate or mocap_frame_rate): tell it (import, view: "
      "--fps; convert, render: --source-fps)");
}

}  // namespace

void turn_z_up_to_y_up(Clip& clip) {
  const Eigen::Quaterniond turn(std::sqrt(0.5), -std::sqrt(0.5), 0, 0);  // -90 degrees about x
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    auto root = clip.poses.row(t).segment<3>(0);
    root =
        axis_angle_from_quaternion(turn * quaternion_from_axis_angle(root.transpose())).transpose();
    clip.trans.row(t) = Eigen::RowVector3d(clip.trans(t, 0), clip.trans(t, 2), -clip.trans(t, 1));
  }
}

Clip read_npz(const fs::path& path, UpAxis up, std::optional<double> fps) {
  const AmassReader reader(path);
  Clip clip;
  clip.name = path.stem().string();
  const bool z_up_layout = read_poses(reader, up, clip);
  read_trans(reader, clip);
  clip.fps = fps ? *fps : read_rate(reader);
  check_clip(clip, reader.file());
  if (up == UpAxis::z || (up == UpAxis::automatic && z_up_layout)) turn_z_up_to_y_up(clip);
  return clip;
}

void write_npz(const fs::path& path, const Clip& clip, Flush flush) {
  check_clip(clip, path.string());
  const auto frames = static_cast<std::size_t>(clip.frames());
  const std::vector<double> betas(16, 0.0);
  write_zip(path,
            {{"poses.npy", npy_bytes(clip.poses.data(), {frames, 72})},
             {"trans.npy", npy_bytes(clip.trans.data(), {frames, 3})},
             {"betas.npy", npy_bytes(betas.data(), {16})},
             {"gender.npy", npy_bytes("neutral")},
             {"mocap_framerate.npy", npy_bytes(&clip.fps, {})}},
            flush);
}

}  // namespace mocaplm
