// The names of AIST++ motion files (.pkl; smpl_record.h reads them). Li et al., "AI Choreographer:
// Music Conditioned 3D Dance Generation with AIST++", 2021; google.github.io/aistplusplus_dataset.
//
// A pickled dictionary of numpy arrays, always 60 frames per second and Y up:
//   smpl_poses    (N, 72) floats, rotation vectors in radians
//   smpl_trans    (N, 3) floats; metres = smpl_trans / smpl_scaling
//   smpl_scaling  (1,) float, about 93
//   smpl_loss     ignored
#pragma once

#include <optional>
#include <string>

#include "motion/clip.h"

namespace mocaplm {

// What a name of the form gWA_sBM_cAll_d26_mWA2_ch03 says, nothing for other names. Other tools cut
// dances into pieces and name the camera that a piece is seen by (c01): pieces end in _seg3,
// _slice0 or both, and belong to the dance `dance`, the name with cAll and without them. Labels:
//   genre         break, pop, lock, middle-hip-hop, la-hip-hop, house, waack, krump, street-jazz,
//                 ballet-jazz
//   situation     basic (sBM) or advanced (sFM)
//   dancer, music, choreography   as written: d26, mWA2, ch03
struct AistName {
  Labels labels;
  std::string dance;
};
std::optional<AistName> parse_aist_name(const std::string& stem);
// Its labels alone.
std::optional<Labels> aist_labels(const std::string& stem);

}  // namespace mocaplm
