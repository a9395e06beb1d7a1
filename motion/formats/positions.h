// Files of joint positions: .npy and arrays of .npz, .csv, .trc. They become motion by inverse
// kinematics (motion/ik/fit.h); how far the figure's joints then lie from the file's is a remark of
// the kind "residual", in centimetres.
//
//   .npy   (frames, 22, 3): SMPL's joints without hands, as HumanML3D and the generators of text to
//          motion write them, 20 frames per second where nothing else is said; (frames, 24, 3):
//          SMPL's; 45, 52, 55, 73, 127 or 144 joints: those of SMPL's, SMPL-H's and SMPL-X's
//          models, which begin with SMPL's. Also (frames, 66), (frames, 72), and with a leading 1.
//   .csv   a header with NAME_x, NAME_y, NAME_z for every joint and a column `time`, as this
//   program
//          writes it (joint_csv.h), or with other names (joint_vocabulary.h)
//   .trc   tracks of joint centres, as OpenSim, Pose2Sim and Theia write them (trc.cpp)
//
// Which way is up (a body stands upright most of the time) and the unit (it has a person's size)
// come from the motion where the format does not say them; both are remarks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "motion/formats/formats.h"
#include "motion/formats/numpy_array.h"
#include "motion/formats/position_table.h"

namespace mocaplm {

// By the extension. Throws DataError for damaged files, for arrays that are no positions of joints
// (features, rotations and joints of another order are called that) and as motion_from_positions
// does.
std::vector<ReadMotion> read_positions_file(const std::filesystem::path& path,
                                            const ReadOptions& options);

// An array of positions of any file, named `name`; `fps` is what the file says. `file` and `key`
// stand for the file and the array in messages.
ReadMotion read_position_array(const NumpyArray& array, const std::string& name,
                               const std::string& file, const std::string& key,
                               std::optional<double> fps, const ReadOptions& options);
// Whether the array's shape is one of those above.
bool is_position_array(const NumpyArray& array);

// Whether the head of a .csv, .npy or .trc file says that positions of joints follow: the first two
// may be anything. False for files that cannot be read.
bool holds_positions(const std::filesystem::path& path);

// The readers behind read_positions_file, up to the table.
PositionTable table_of_array(const NumpyArray& array, const std::string& file,
                             const std::string& key);
PositionTable read_position_csv(const std::string& text, const std::string& file);
// Names of the points with three columns, in their order; none where the line is no such header.
std::vector<std::string> position_columns(const std::string& header);
PositionTable read_trc(const std::string& text, const std::string& file);

}  // namespace mocaplm
