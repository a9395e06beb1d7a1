// How a page carries the points of a motion: each point's path as what is left after a guess,
// deflated, in base64. A minute at 60 fps takes about 0.2 MB instead of 0.9 MB.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mocaplm {

// `values` is (frames, channels). Channel by channel, x(t) is guessed from the two values before it
// as 2 x(t-1) - x(t-2) (as x(t-1) for t = 1, as 0 for t = 0). The differences, modulo 2^16 and
// folded so that small ones of either sign are small (0, -1, 1, -2, ... -> 0, 1, 2, 3, ...), are
// written as all low bytes and then all high bytes, both in the order (channels, frames), in zlib's
// format (RFC 1950). assets/unpack.js is the way back. Throws Error when zlib has no memory.
std::string pack_points(const std::vector<std::int16_t>& values, std::int64_t channels);

}  // namespace mocaplm
