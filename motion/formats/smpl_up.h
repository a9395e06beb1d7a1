// Which axis of an SMPL file points up, as the motion itself tells: in most frames of a person's
// motion the head is above the pelvis and the feet are below it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/formats.h"

namespace mocaplm {

// The axis along which the body stands in nearly all frames (of at most 100 that are looked at) of
// a motion in its file's own axes; none where there is no such axis: somebody lies, crawls, turns
// somersaults. `expected` is what the file's layout says, or automatic: a motion that may be meant
// as it is (lying on the floor, standing on the hands) is not taken to say something else.
std::optional<UpAxis> find_up(const Clip& clip, UpAxis expected);

// How sure a layout is of its axis: said in the file, a program's habit, or not at all.
enum class UpLayout { fixed, usual, unknown };

// The axis to turn up. `asked` is the user's and decides; then the motion, and where it is not
// clear the layout's `expected`, which must be more than a habit where that matters. Adds a remark
// for what the motion decided against the layout, and for what nobody could confirm. Throws
// DataError that asks for --up where neither says.
UpAxis decide_up(const Clip& clip, UpAxis asked, UpAxis expected, UpLayout layout,
                 const std::string& file, std::vector<Remark>& remarks);

}  // namespace mocaplm
