// A clip as a figure that moves: glTF 2.0 in its binary form (.glb), as Blender, game engines,
// viewers on the web and the systems' own viewers open it. Khronos Group, "glTF 2.0 Specification",
// 2021 (ISO/IEC 12113:2022).
//
//   0   "glTF", version 2, length of the file                    (u32 each, little-endian)
//   12  length, "JSON", text, padded with spaces to a multiple of 4
//   ..  length, "BIN\0", the numbers that the text points to, padded with zeros
//
// Nodes 0 to 23 are SMPL's joints, each at its bone in the rest pose (a T-pose with the soles at
// height 0), node 24 the skinned figure (motion/body_mesh.h) whose bind pose this is. One animation
// named as the clip: the rotation of every joint and the translation of the pelvis at every frame,
// linear in between, quaternions (x, y, z, w) of neighbouring frames on one hemisphere. Metres, Y
// up, facing +Z; all numbers as 4-byte floats. The animation's extras hold "fps" and the labels.
#pragma once

#include <filesystem>
#include <string>

#include "motion/clip.h"

namespace mocaplm {

// Throws DataError when the clip has over 2^23 frames, which the format cannot hold.
std::string glb_bytes(const Clip& clip);

// Writes it; throws DataError when the clip is not sound (check_clip), too long, or the disk
// refuses.
void write_glb(const std::filesystem::path& path, const Clip& clip);

}  // namespace mocaplm
