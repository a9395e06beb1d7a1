// Motion files of every known format, told apart by extension and checked by their first bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/bvh_unit.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

struct RetargetReport;

struct ReadOptions {
  std::optional<double> fps;      // overrides the file's rate; (0, 10000]
  UpAxis up = UpAxis::automatic;  // overrides the format's up axis
  std::string bvh_map;            // a JSON map for a BVH skeleton whose joint names are not known
};

// Whether the extension is one that read_clip knows (.npz, .pkl, .bvh, in any case).
bool is_motion_file(const std::filesystem::path& path);

// Reads an AMASS .npz, an AIST++ .pkl or a .bvh. Throws DataError for unknown extensions, for a
// file that is not what its extension says (naming what it looks like), and as read_npz,
// read_aist_pkl and read_bvh_clip do; UsageError for a rate out of range. The result has passed
// check_clip. `report` receives how a BVH's limbs were matched.
Clip read_clip(const std::filesystem::path& path, const ReadOptions& options = {},
               RetargetReport* report = nullptr);

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
