// AIST++ motion files (.pkl) and their names. Li et al., "AI Choreographer: Music Conditioned 3D
// Dance Generation with AIST++", 2021; google.github.io/aistplusplus_dataset.
//
// A pickled dictionary of numpy arrays, always 60 frames per second and Y up:
//   smpl_poses    (N, 72) floats, rotation vectors in radians
//   smpl_trans    (N, 3) floats; metres = smpl_trans / smpl_scaling
//   smpl_scaling  (1,) float, about 93
//   smpl_loss     ignored
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "motion/clip.h"
#include "motion/formats/up_axis.h"

namespace mocaplm {

// Every frame, poses bit for bit as stored; the clip's name is the file's stem. Nothing in the file
// is executed (pickle.h). `fps` overrides the 60. Throws DataError naming the byte, frame or joint.
Clip read_aist_pkl(const std::filesystem::path& path, UpAxis up = UpAxis::automatic,
                   std::optional<double> fps = std::nullopt);

// The labels that a name of the form gWA_sBM_cAll_d26_mWA2_ch03 gives, nothing for other names:
//   genre         break, pop, lock, middle-hip-hop, la-hip-hop, house, waack, krump, street-jazz,
//                 ballet-jazz
//   situation     basic (sBM) or advanced (sFM)
//   dancer, music, choreography   as written: d26, mWA2, ch03
std::optional<Labels> aist_labels(const std::string& stem);

}  // namespace mocaplm
