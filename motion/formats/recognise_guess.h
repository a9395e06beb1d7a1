// A first guess by names alone, for figures whose tree is not recognised: to be corrected by hand.
#pragma once

#include <array>
#include <vector>

#include "motion/formats/joint_words.h"
#include "motion/skeleton.h"

namespace mocaplm {

// Sets those of SMPL's joints whose part a name says, each from the first such joint of the file
// (in its order, parents first); of two legs or arms of one side the first is the upper one. Others
// stay as they are.
void guess_by_words(const std::vector<JointWord>& words, std::array<int, kJoints>& joints);

}  // namespace mocaplm
