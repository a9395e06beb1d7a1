// Which joint of an unknown skeleton is which of SMPL's: from the tree (two limbs from one joint,
// two more and a head from another), the lengths of its bones, and the words in the joints' names.
#pragma once

#include <array>
#include <string>

#include "motion/formats/bvh.h"
#include "motion/skeleton.h"

namespace mocaplm {

struct Recognised {
  std::array<int, kJoints> joints;  // of the file, -1 for none
  // What speaks against it, a sentence; empty: certain. The joints are the best guess all the same.
  std::string doubt;
};

// Needs nothing but hierarchy and lengths (of frame 0, where positions are channels). Sides come
// from the names, else from where the toes point. A wrist or ankle that is missing may be an End
// Site (limb_ends.h). Never throws.
Recognised recognise_body(const Bvh& bvh);

// The spine's joints from `pelvis` (not included) up to `chest` (included), by SMPL's three.
// One is the chest, two are SMPL's spine2 and spine3, of more than three the first, the one nearest
// to the middle by height and the last.
void assign_spine(const std::vector<int>& spine, const std::vector<double>& heights,
                  std::array<int, kJoints>& joints);

// The joints from `ancestor` (not included) down to `joint` (included); empty when it is none.
std::vector<int> path_down(const Bvh& bvh, int ancestor, int joint);
// The lowest joint that both hang from, or are.
int common_ancestor(const Bvh& bvh, int a, int b);
// Whether `joint` hangs from `above`, or is it.
bool is_below(const Bvh& bvh, int joint, int above);

}  // namespace mocaplm
