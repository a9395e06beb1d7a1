// What mocaplm-scene does: a file through assimp (Debian's libassimp 5.2) as a Scene.
#pragma once

#include <filesystem>

#include "motion/formats/scene.h"

namespace mocaplm {

// Reads .fbx (7.1 and newer), .dae, .gltf, .glb and .vrma, told apart by their first bytes. Throws
// DataError naming the file for what is none of these and with assimp's own words for what it
// refuses.
Scene read_with_assimp(const std::filesystem::path& path);

}  // namespace mocaplm
