// AMASS motion files (.npz: a zip archive of .npy arrays), read and written. Mahmood et al.,
// "AMASS: Archive of Motion Capture as Surface Shapes", 2019; https://amass.is.tue.mpg.de.
//
//   poses            (N, C) floats, rotation vectors in radians. C = 72: SMPL's 24 joints, Y up.
//                    C = 156 (SMPL+H) and 165 (SMPL-X): the body is columns 0..65 and Z is up, but
//                    for SMPL-X files of other programs (EMAGE), which have Y up.
//                    C = 66 (the body alone): found with either axis up.
//                    SMPL-X files without it: root_orient (N, 3) and pose_body (N, 63), Z up.
//                    What the motion itself says goes before all of these (smpl_up.h).
//   trans            (N, 3) floats, metres
//   mocap_framerate  or mocap_frame_rate: one number, frames per second
//   betas, gender    the body's shape
//   up_axis          "y", rest_joints (24, 3): this program's own
//   dmpls, ...       are ignored
#pragma once

#include <filesystem>
#include <optional>

#include "common/files.h"
#include "motion/clip.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// Every frame at the file's rate (a rate within 1e-3 of a whole number is that number), or at `fps`
// where it is given. Files with another axis up are turned as turn_world does (Z up: by -90 degrees
// about x); all other values are the file's, bit for bit. The hands are zero but for 72 columns.
// The clip's name is the file's stem. Throws DataError naming entry and byte, frame or joint:
// damaged or hostile files, no motion (AMASS's shape.npz), no frame rate, other layouts, values
// that are not finite.
Clip read_npz(const std::filesystem::path& path, UpAxis up = UpAxis::automatic,
              std::optional<double> fps = std::nullopt);

// Writes poses (N, 72) and trans (N, 3) as doubles, Y up, betas and gender of the clip's body (16
// zeros and "neutral" where they are not known), mocap_framerate and up_axis, and rest_joints where
// the body's are known, stored; the same clip gives the same bytes. Throws DataError when the clip
// is not sound (check_clip) or the disk refuses.
void write_npz(const std::filesystem::path& path, const Clip& clip, Flush flush = Flush::now);

}  // namespace mocaplm
