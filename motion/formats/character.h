// A clip on a figure of the user's own: a .glb (or a VRM character, which is one) whose bones are
// found gets the motion as an animation. Mesh, skin, materials, textures and everything else stay
// as they are in the file. An .fbx becomes a .glb first (read_character_glb).
//
// Bones are found by what VRM says of them (VRMC_vrm 1.0 and VRM 0.x: humanoid.humanBones), else by
// their names as those of a .bvh file are (detect_map). Each turns as the clip's joint does, seen
// from the rest pose of each; arms and legs are first laid in the directions that SMPL's rest pose
// has, so a T- and an A-pose give the same. The way of the hips is scaled by the length of the
// legs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

class Character {
 public:
  // Reads the file. Throws DataError: no .glb or .fbx, damaged, its numbers not inside it, no
  // humanoid bones found, not standing in a T- or A-pose.
  explicit Character(const std::filesystem::path& file);
  ~Character();
  Character(Character&&) noexcept;
  Character& operator=(Character&&) noexcept;

  // SMPL's joint names with the file's nodes that they move: "left_hip" -> "LeftUpLeg"; "" for
  // none.
  std::vector<std::pair<std::string, std::string>> bones() const;
  // Length of the character's legs over those of the clip's body.
  double scale(const Clip& clip) const;

  // The file with the clip as the first of its animations. Throws DataError over 2^23 frames.
  std::string animated(const Clip& clip) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mocaplm
