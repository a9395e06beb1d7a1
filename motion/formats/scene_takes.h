// The takes of a scene as motion in the form of a .bvh file, so that everything that is done for
// those is done for these.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/bvh.h"
#include "motion/formats/scene.h"

namespace mocaplm {

struct SceneMotion {
  std::string name;  // of the take; unique, without '/' and control characters, not empty
  Bvh bvh;
  std::vector<Remark> remarks;
};

struct SceneMotions {
  std::vector<SceneMotion> motions;  // at least one
  std::vector<Remark> remarks;       // of takes that were left out
};

// For each take the joints of scene_skeleton with axes along the world's, whose zero pose is the
// rest pose, in metres and with Y up as the file says (`own_axes`: with the file's own axes). A
// joint's rotation is its turn from the rest pose: world rotation R of the node, B at rest, R B^-1,
// as local ZXY angles; scales in the tree are in the places of the joints. Joints whose place
// changes relative to their parents' have position channels. The rate is scene_rate's. Takes in
// which no joint moves are left out with a remark. Throws NoMotion when there is no skeleton or no
// take that moves it, DataError for a take that is too long, and for a joint that is turned inside
// out in some frame.
SceneMotions scene_motions(const Scene& scene, const std::string& file, bool own_axes = false);

}  // namespace mocaplm
