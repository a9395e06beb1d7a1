// One person's motion in the keys of some program, found in a dictionary of arrays.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/array_dict.h"
#include "motion/formats/smpl_up.h"

namespace mocaplm {

// Frames per second of the videos that programs find people in, where nobody says.
constexpr double kVideoFps = 30;

struct SmplRecord {
  Poses poses;                    // the hands are zero but for SMPL's own 24 joints
  Translations trans;             // SMPL's, in the file's axes; metres
  std::string program;            // "AMASS", "AIST++", "EDGE", ...: for messages
  bool trans_is_pelvis = false;   // the pelvis lies at `trans` itself
  std::optional<double> fps;      // as the file says
  double usual_fps = 0;           // of that program, where files do not say it; 0: none
  UpAxis up = UpAxis::automatic;  // of that program's files; automatic: nobody knows
  UpLayout layout = UpLayout::unknown;
  BodyShape body;
  std::vector<Remark> remarks;
};

// Keys that are understood, in the order in which they are looked for:
//   smpl_poses, smpl_trans, smpl_scaling       AIST++; without scaling EDGE and its kin, Z up,
//   whose
//                                              root lies at smpl_trans itself; 30 frames per second
//   pose_world, trans_world                    WHAM, in the world; Y up
//   global_orient, body_pose, transl           GVHMR, DART, 4D-Humans, SMPL-X's own names
//   root_orient, pose_body, trans              AMASS's SMPL-X; Z up
//   poses, trans                               AMASS; by its columns, see npz.h
//   pred_rotmat, pred_trans                    TRAM, in the camera; Y down
//   pose, trans                                WHAM and VIBE in the camera; Y down
// `keys` of other kinds give none. Throws DataError for arrays that are not what their key says.
std::optional<SmplRecord> read_smpl_record(const ArrayDict& dict);

// Frames per second, under whatever key they are said.
std::optional<double> frame_rate(const ArrayDict& dict);

// The key under which joint positions (frames, 22 or 24, 3) lie; "" for none.
std::string positions_key(const ArrayDict& dict);

// What a dictionary without a record seems to hold, for a message: "HumanML3D's features"; "".
std::string other_content(const ArrayDict& dict);

}  // namespace mocaplm
