// Values that a recorder lost and wrote as "nan", "-nan(ind)", "inf" or "1.#IND".
#pragma once

#include <string>
#include <string_view>

#include "motion/formats/bvh.h"

namespace mocaplm {

// Whether a word of the motion part is one that programs write where they have no number.
bool is_gap(std::string_view word);

// Interpolates the values of `bvh` that are nan: positions linearly, the rotation of a joint with
// three rotation channels as a whole along the shortest arc (slerp) though only one angle is
// missing, those of fewer channels angle by angle the shorter way round; at both ends the next
// value is held. Throws DataError naming joint and frames where a gap lasts longer than a second at
// `fps` or a joint never has a value.
void fill_gaps(Bvh& bvh, double fps, const std::string& file);

}  // namespace mocaplm
