// Motion files of every known format, told apart by extension and checked by their first bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/bvh_unit.h"
#include "motion/formats/retarget_report.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// What every command that reads motion can be told about its files.
struct ReadOptions {
  std::optional<double> fps;      // overrides the file's rate; (0, 10000]
  UpAxis up = UpAxis::automatic;  // overrides the format's up axis
  std::optional<double> unit;     // metres per unit of the file, where lengths have one; 1e-6 to 1e6
  std::string bvh_map;            // a JSON map for a skeleton that is not recognised
  bool keep_path = false;         // the root's own path, not scaled by the legs
  bool fill_gaps = false;         // values that are nan for up to a second are interpolated
  std::int64_t drop_first = 0;    // leading frames to leave out
  std::string part;  // of a file with several people or takes: the name of one; "": its only one
  std::string body;  // an SMPL model file: joints of the clip's own shape
};

// What a reader took for granted or found odd. `kind` is the same for the same trouble in other
// files, so that many files give one message: "frames announced".
struct Remark {
  std::string kind;
  std::string text;  // a sentence without the file's name and without a full stop
};

struct ReadReport {
  RetargetReport retarget;  // how a skeleton was matched; `scheme` is empty for SMPL's own poses
  std::vector<Remark> remarks;
};

struct ReadMotion {
  Clip clip;
  ReadReport report;
};

// Whether the extension is one that read_clip knows (.npz, .pkl, .bvh, .fbx, .glb, .gltf,
// .vrma, .dae, in any case).
bool is_motion_file(const std::filesystem::path& path);

// Reads all motions of a file: its people or takes, whose clips are named "STEM_PART"; a single one
// is named as the file's stem. With `options.part` that one alone. Throws DataError for unknown
// extensions, for a file that is not what its extension says (naming what it looks like), and as
// read_npz, read_aist_pkl, read_bvh_clip and read_scene_clips do; UsageError for a rate out of range.
// The clips have passed check_clip and are not empty.
std::vector<ReadMotion> read_clips(const std::filesystem::path& path,
                                   const ReadOptions& options = {});

// The only motion of a file. Throws as read_clips does, and DataError naming the parts of a file
// that holds several.
Clip read_clip(const std::filesystem::path& path, const ReadOptions& options = {},
               ReadReport* report = nullptr);

struct WriteOptions {
  BvhUnit bvh_unit = BvhUnit::centimetres;
};

// What write_clip can write, without a dot: "npz", "bvh", "glb", "csv".
const std::vector<std::string>& written_formats();

// Throws UsageError unless the path's extension is one of these, in any case.
void check_written_format(const std::filesystem::path& path);

// Writes an AMASS .npz, a .bvh, a .glb with a figure (glb.h) or a .csv of joint positions
// (joint_csv.h), by the extension. Throws UsageError for other extensions, DataError when the clip
// is not sound or the disk refuses.
void write_clip(const std::filesystem::path& path, const Clip& clip,
                const WriteOptions& options = {});

}  // namespace mocaplm
