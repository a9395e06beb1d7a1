// AMASS motion files (.npz: a zip archive of .npy arrays), read and written. Mahmood et al.,
// "AMASS: Archive of Motion Capture as Surface Shapes", 2019; https://amass.is.tue.mpg.de.
//
//   poses            (N, C) floats, rotation vectors in radians. C = 72: SMPL's 24 joints, Y up.
//                    C = 156 (SMPL+H) and 165 (SMPL-X): the body is columns 0..65 and Z is up.
//                    C = 66 (the body alone): needs to be told which axis is up.
//                    SMPL-X files without it: root_orient (N, 3) and pose_body (N, 63), Z up.
//   trans            (N, 3) floats, metres
//   mocap_framerate  or mocap_frame_rate: one number, frames per second
//   betas, gender, dmpls, ... are ignored
#pragma once

#include <filesystem>
#include <optional>

#include "common/files.h"
#include "motion/clip.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// Every frame at the file's rate (a rate within 1e-3 of a whole number is that number), or at `fps`
// where it is given. Files with Z up are turned by -90 degrees about x: the root's rotation and
// `trans`, as a vector about the origin; all other values are the file's, bit for bit. The hands
// are zero but for 72 columns. The clip's name is the file's stem. Throws DataError naming entry
// and byte, frame or joint: damaged or hostile files, no motion (AMASS's shape.npz), no frame rate,
// other layouts, values that are not finite.
Clip read_npz(const std::filesystem::path& path, UpAxis up = UpAxis::automatic,
              std::optional<double> fps = std::nullopt);

// Writes poses (N, 72) and trans (N, 3) as doubles, Y up, betas (16 zeros), gender "neutral" and
// mocap_framerate, stored; the same clip gives the same bytes. Throws DataError when the clip is
// not sound (check_clip) or the disk refuses.
void write_npz(const std::filesystem::path& path, const Clip& clip, Flush flush = Flush::now);

// Turns Z up to Y up as above.
void turn_z_up_to_y_up(Clip& clip);

}  // namespace mocaplm
