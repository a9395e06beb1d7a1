// Motion files of every known format, told apart by extension and checked by their first bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/bvh_unit.h"
#include "motion/formats/out_scheme.h"
#include "motion/formats/remark.h"
#include "motion/formats/retarget_report.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// What every command that reads motion can be told about its files.
struct ReadOptions {
  std::optional<double> fps;      // overrides the file's rate; (0, 10000]
  UpAxis up = UpAxis::automatic;  // overrides the format's up axis
  std::optional<double> unit;   // metres per unit of the file, where lengths have one; 1e-6 to 1e6
  std::string bvh_map;          // a JSON map for a skeleton that is not recognised
  std::string write_map;        // where the map that was found or guessed is written
  bool keep_path = false;       // the root's own path, not scaled by the legs
  bool fill_gaps = false;       // values that are nan for up to a second are interpolated
  std::int64_t drop_first = 0;  // leading frames to leave out
  std::string part;  // of a file with several people or takes: the name of one; "": its only one
  std::string body;  // an SMPL model file: joints of the clip's own shape
};

struct BvhOptions;
// What of these options is a .bvh's, or any skeleton's.
BvhOptions bvh_options(const ReadOptions& options);

struct ReadReport {
  RetargetReport retarget;  // how a skeleton was matched; `scheme` is empty for SMPL's own poses
  std::vector<Remark> remarks;
};

struct ReadMotion {
  Clip clip;
  ReadReport report;
};

// Whether the extension is one that read_clip knows (.npz, .pkl, .npy, .pt, .bvh, .fbx, .glb,
// .gltf, .vrma, .dae, .csv, .trc, in any case).
bool is_motion_file(const std::filesystem::path& path);
// The same for a file found in a folder: a .csv or .npy, which may be anything, must hold positions
// of joints by its head.
bool looks_like_motion(const std::filesystem::path& path);

// Reads all motions of a file: its people or takes, whose clips are named "STEM_PART"; a single one
// is named as the file's stem. With `options.part` that one alone. Throws DataError for unknown
// extensions, for a file that is not what its extension says (naming what it looks like), and as
// read_npz, read_aist_pkl, read_bvh_clip and read_scene_clips do; UsageError for a rate out of
// range. The clips have passed check_clip and are not empty.
std::vector<ReadMotion> read_clips(const std::filesystem::path& path,
                                   const ReadOptions& options = {});

// The only motion of a file. Throws as read_clips does, and DataError naming the parts of a file
// that holds several.
Clip read_clip(const std::filesystem::path& path, const ReadOptions& options = {},
               ReadReport* report = nullptr);

class Character;  // motion/formats/character.h

struct WriteOptions {
  BvhUnit bvh_unit = BvhUnit::centimetres;     // .bvh
  OutScheme skeleton = OutScheme::smpl;        // .bvh, .glb; a .vrma always has VRM's
  std::shared_ptr<const Character> character;  // .glb: this figure moves, not the program's own
};

// What write_clip can write, without a dot: "npz", "bvh", "glb", "vrma", "csv".
const std::vector<std::string>& written_formats();

// Throws UsageError unless the path's extension is one of these, in any case, and its format has
// what the options ask for.
void check_written_format(const std::filesystem::path& path, const WriteOptions& options = {});

// Writes an AMASS .npz, a .bvh, a .glb with a figure or a .vrma (glb.h) or a .csv of joint
// positions (joint_csv.h), by the extension. Throws as check_written_format does, and DataError
// when the clip is not sound or the disk refuses.
void write_clip(const std::filesystem::path& path, const Clip& clip,
                const WriteOptions& options = {});

}  // namespace mocaplm
