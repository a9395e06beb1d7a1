// What the readers of joint positions hand on: columns of named points, before anything is known
// about the body.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/formats/formats.h"
#include "motion/ik/points.h"

namespace mocaplm {

struct PositionTable {
  std::string file;                // for messages
  std::vector<std::string> names;  // of the points, three columns each
  // (frames, 3 * names), in the file's unit and axes; nan where the file gives nothing.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> places;
  std::optional<double> fps;    // where the file says it, or its format
  std::optional<double> unit;   // metres, where the file says it
  bool y_up = false;            // Y is up by the format, whatever the motion says
  bool by_custom_y_up = false;  // HumanML3D's way of writing, see motion_from_positions
  std::vector<Remark> remarks;
};

// Joints from a table to a motion named `name`: points by their names, gaps, axes, size, and the
// fit. Throws DataError for names that are no joints of a body (skin markers are called that),
// without a rate anywhere, for gaps (see ReadOptions::fill_gaps), for positions that cannot be a
// person's, and where which way is up cannot be told.
//
// People who lie for all of a clip show the wrong axis or none. HumanML3D puts the lowest joint at
// height 0 and the first pelvis over the origin: files `by_custom_y_up` that do so, or that show no
// axis, keep Y.
ReadMotion motion_from_positions(PositionTable table, const std::string& name,
                                 const ReadOptions& options);

}  // namespace mocaplm
