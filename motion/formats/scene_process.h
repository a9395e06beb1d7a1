// Reading a scene file in another process: the program mocaplm-scene (app/scene), which loads
// assimp. A file that makes assimp crash, hang or eat memory costs that process and nothing else.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "motion/formats/scene.h"

namespace mocaplm {

struct SceneReader {
  std::filesystem::path program;                                   // empty: find_scene_reader()
  std::chrono::milliseconds patience = std::chrono::seconds(120);  // then it is killed
  std::uintmax_t max_file = std::uintmax_t{512} << 20, max_answer = std::uintmax_t{768} << 20;
};

// mocaplm-scene as the environment's MOCAPLM_SCENE names it, beside this program, or on the PATH;
// an empty path when it is nowhere.
std::filesystem::path find_scene_reader();

// Throws DataError naming the file: when it is too large, when the reader is not installed, refuses
// the file, crashes, runs out of memory or time, or answers what parse_scene refuses.
Scene read_scene(const std::filesystem::path& path, const SceneReader& reader = {});

// The character of an .fbx as the bytes of a .glb: nodes, meshes, skins, materials, textures inside
// the file; metres, Y up, no animation. Throws as read_scene does, also without a skin.
std::string read_character_glb(const std::filesystem::path& path, const SceneReader& reader = {});

}  // namespace mocaplm
