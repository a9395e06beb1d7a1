// glTF before assimp sees it: what assimp 5.2 gets wrong, or does not need, is put right in the
// JSON.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/formats.h"

namespace mocaplm {

// The text of a .gltf or the bytes of a .glb (glTF 2.0), made plain:
//   - nodes have unique names, since assimp finds a node by its name; in a .vrma those of VRM's
//   bones
//   - materials, textures, images, morph targets and channels that move no node are gone
//   - a scene is there
//   - meshes in Draco's compression are gone, and with them their skins
// Throws DataError for other versions, nodes in a circle or under two parents, and for keys that
// are stored as whole numbers, which assimp takes for floats. Adds a remark where keys are joined
// otherwise than by straight lines.
std::string plain_gltf(const std::string& bytes, const std::string& file,
                       std::vector<Remark>& remarks);

}  // namespace mocaplm
