// What the lengths in a .bvh file that is written count.
#pragma once

namespace mocaplm {

// Centimetres are what most animation programs take a .bvh file's lengths for.
enum class BvhUnit { centimetres, metres };

}  // namespace mocaplm
