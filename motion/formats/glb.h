// A clip as a figure that moves: glTF 2.0 in its binary form (.glb), as Blender, game engines,
// viewers on the web and the systems' own viewers open it. Khronos Group, "glTF 2.0 Specification",
// 2021 (ISO/IEC 12113:2022).
//
//   0   "glTF", version 2, length of the file                    (u32 each, little-endian)
//   12  length, "JSON", text, padded with spaces to a multiple of 4
//   ..  length, "BIN\0", the numbers that the text points to, padded with zeros
//
// The first nodes are the skeleton's joints (formats/skeletons.h; 0 to 23: SMPL's), each at its
// bone in the rest pose with the soles at height 0, the last node the skinned figure
// (motion/body_mesh.h) whose bind pose this is. One animation named as the clip: the rotation of
// every joint that turns and the translation of the pelvis at every frame, linear in between,
// quaternions (x, y, z, w) of neighbouring frames on one hemisphere. Metres, Y up, facing +Z; all
// numbers as 4-byte floats. The animation's extras hold "fps" and the labels.
//
// A .vrma file ("VRM Animation", VRM Consortium, VRMC_vrm_animation-1.0) is a .glb with an
// animation and no figure. Its extension says which node is which of VRM's humanoid bones; without
// the animation the nodes stand in VRM's T-pose (VRMC_vrm-1.0, tpose.md): arms along x, legs
// straight down, feet straight ahead. Only the hips have a translation, and nothing has a scale.
#pragma once

#include <filesystem>
#include <string>

#include "motion/clip.h"
#include "motion/formats/out_scheme.h"

namespace mocaplm {

// Throw DataError when the clip has over 2^23 frames, which the format cannot hold.
std::string glb_bytes(const Clip& clip, OutScheme scheme = OutScheme::smpl);
std::string vrma_bytes(const Clip& clip);

// Write it; throw DataError when the clip is not sound (check_clip), too long, or the disk
// refuses.
void write_glb(const std::filesystem::path& path, const Clip& clip,
               OutScheme scheme = OutScheme::smpl);
void write_vrma(const std::filesystem::path& path, const Clip& clip);

}  // namespace mocaplm
