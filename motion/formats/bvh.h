// Biovision hierarchy (.bvh): a tree of joints in text, then one line of channel values a frame.
//
//   HIERARCHY                                      MOTION
//   ROOT hip {                                     Frames: 2
//     OFFSET 0 0 0                                 Frame Time: 0.0333333
//     CHANNELS 6 Xposition ... Zrotation ...       0 90 0 12.5 0 -3 ...
//     JOINT chest { ... End Site { OFFSET 0 8 0 } }
//   }
//
// A joint's rotation is the product of its rotation channels in the order in which they are listed,
// column vectors, degrees: R = R_first R_second R_third. Position channels replace the OFFSET, each
// its own component (Meredith and Maddock, "Motion Capture File Formats Explained", 2001).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/bvh_unit.h"
#include "motion/formats/out_scheme.h"
#include "motion/formats/remark.h"

namespace mocaplm {

// 0..2 are positions along x, y, z in the file's unit; 3..5 rotations about x, y, z in degrees.
enum class BvhChannel { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;
  int parent = -1;  // index of a joint before this one; -1 for the root
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::vector<BvhChannel> channels;        // at most 6, each kind once
  int first_channel = 0;                   // its column in Bvh::values
  std::vector<Eigen::Vector3d> end_sites;  // offsets of the bones that end here
};

struct Bvh {
  std::vector<BvhJoint> joints;
  double frame_time = 0;  // seconds, as written
  double fps = 0;         // what the written digits mean (bvh_frame_rate.h), or as was asked for
  // (frames, channels): every channel of every joint, in the order of the hierarchy.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values;
  std::vector<Remark> remarks;  // slips that did no harm, and what was guessed

  Eigen::Index frames() const { return values.rows(); }
  int channels() const { return static_cast<int>(values.cols()); }
  int joint(const std::string& name) const;  // index, or -1
};

struct BvhTextOptions {
  bool fill_gaps = false;     // interpolate values that are nan (bvh_gaps.h)
  std::optional<double> fps;  // in place of the frame time's
};

// Reads a file of at most 256 MiB and 1,000,000 frames. Slips of the header that leave no doubt of
// the motion are said in `remarks`: more or fewer whole frames than announced, a last line that is
// cut short, End Sites with names, two joints of one name (the second becomes "name_2"), a frame
// time of few digits. Throws DataError naming line, and in the motion part frame, joint and
// channel: bad syntax, a frame with too few or too many values, a file cut short, numbers that are
// not finite.
Bvh read_bvh(const std::filesystem::path& path, const BvhTextOptions& options = {});
// The same for text in memory; `name` stands for the file in messages.
Bvh parse_bvh(std::string_view text, const std::string& name, const BvhTextOptions& options = {});

// World rotation and position of every joint.
struct BvhPose {
  std::vector<Eigen::Matrix3d> rotations;
  std::vector<Eigen::Vector3d> positions;  // in the file's unit
};

// Forward kinematics of one frame; the pose's storage is reused.
void pose_bvh(const Bvh& bvh, Eigen::Index frame, BvhPose& pose);
// The same for some joints only, ascending and each with its ancestors; the others are left alone.
void pose_bvh(const Bvh& bvh, Eigen::Index frame, const std::vector<std::size_t>& joints,
              BvhPose& pose);
// The same for `channels` values of one's own.
void pose_bvh_values(const Bvh& bvh, const double* values, BvhPose& pose);
// Of some frames, evenly through the file and at most 24; only these joints are posed, each after
// its parent.
std::vector<BvhPose> some_poses(const Bvh& bvh, const std::vector<std::size_t>& joints);
// The zero pose: no rotation, joints at their OFFSETs.
BvhPose rest_bvh(const Bvh& bvh);

// A clip as BVH text on the skeleton of `scheme`: six channels for the joint that travels and for
// the root, ZXY rotations for all joints. As SMPL's own 24 joints, reading it back with
// read_bvh_clip gives the same rotations to 1e-7 rad and the same translation to 1e-8 m.
std::string bvh_text(const Clip& clip, BvhUnit unit = BvhUnit::centimetres,
                     OutScheme scheme = OutScheme::smpl);
// Writes it; throws DataError when the clip is not sound (check_clip) or the disk refuses.
void write_bvh(const std::filesystem::path& path, const Clip& clip,
               BvhUnit unit = BvhUnit::centimetres, OutScheme scheme = OutScheme::smpl);

}  // namespace mocaplm
