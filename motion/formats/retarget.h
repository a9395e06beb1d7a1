// From any skeleton of a .bvh file to SMPL's: rotations relative to the T-pose, limbs turned into
// the source's bone directions.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/bvh.h"
#include "motion/formats/retarget_map.h"
#include "motion/formats/retarget_report.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

struct BvhOptions {
  std::optional<double> fps;  // overrides the file's frame time; (0, 10000]
  std::string map_file;       // a JSON map (docs/bvh-maps.md); "" = known by its joint names
  std::optional<double>
      unit;  // metres per unit of the file; default: the map's, else from the figure's size
  UpAxis up = UpAxis::automatic;  // of the motion; the rest pose may have another
  bool keep_path = false;         // the root's own path, not scaled by the legs
  bool fill_gaps = false;         // values that are nan for up to a second are interpolated
  std::string write_map;          // where the map that is found or guessed is written; "": nowhere
  // The root's positions count from the world's origin, never from its OFFSET: of scene files.
  bool absolute_root = false;
};

// Reads a .bvh file as a clip of SMPL's skeleton; the clip's name is the file's stem. Every frame
// is kept, at the file's rate. Rotation vectors continue in time where components of at most pi
// allow it. Throws DataError (see read_bvh, detect_map, load_map) and UsageError for options out of
// range.
Clip read_bvh_clip(const std::filesystem::path& path, const BvhOptions& options = {},
                   RetargetReport* report = nullptr);

// The same for a file that was already read; `file` stands for it in messages.
Clip retarget_bvh(const Bvh& bvh, const std::string& file, const BvhOptions& options = {},
                  RetargetReport* report = nullptr);
// The same with a map in hand; `options.map_file` is not read.
Clip retarget_bvh(const Bvh& bvh, const RetargetMap& map, const std::string& file,
                  const BvhOptions& options, RetargetReport* report);

}  // namespace mocaplm
