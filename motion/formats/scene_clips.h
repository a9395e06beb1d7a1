// Motion of characters from scene files: .fbx, .glb, .gltf, .vrma and .dae.
#pragma once

#include <filesystem>
#include <vector>

#include "motion/formats/formats.h"
#include "motion/formats/scene_process.h"

namespace mocaplm {

// One clip for each take that moves the skeleton, converted as a .bvh file's motion (retarget.h);
// with `options.part` that take alone. A single one is named as the file's stem, of several each
// STEM_TAKE. `options.unit` is metres per unit of the file; `options.up` the axis of the file that
// points up, whatever it says. Throws as read_scene, scene_motions and retarget_bvh do, and
// DataError naming the takes for a part that is not there.
std::vector<ReadMotion> read_scene_clips(const std::filesystem::path& path,
                                         const ReadOptions& options,
                                         const SceneReader& reader = {});

}  // namespace mocaplm
