// The two parts of a BVH text.
#pragma once

#include "motion/formats/bvh.h"
#include "motion/formats/bvh_cursor.h"

namespace mocaplm {

// "Xposition", ... by BvhChannel.
const std::vector<std::string>& bvh_channel_names();

// Reads from ROOT to the brace that closes it: joints with their channels, and remarks.
void parse_hierarchy(BvhCursor& cursor, Bvh& bvh);

// Reads from "Frames:" to the end: frame time, rate, values, and remarks.
void parse_motion(BvhCursor& cursor, Bvh& bvh, const BvhTextOptions& options);

}  // namespace mocaplm
