// A character of an .fbx as a .glb, by assimp's own exporter.
#pragma once

#include <filesystem>
#include <string>

namespace mocaplm {

// Nodes, meshes, skins with at most four weights a vertex, materials and the textures inside the
// file; in metres and with Y up, without animations. Throws DataError naming the file: no .fbx, no
// skin, what assimp refuses to read or write.
std::string character_glb(const std::filesystem::path& path);

}  // namespace mocaplm
