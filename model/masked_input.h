// What a masked language model sees (thesis 4.5.2 and Figure 4.6): a window of tokens of which some
// are hidden, each position predicting its own token from all that are not. Everything here is
// worked out from the visible tokens alone.
#pragma once

#include "model/input.h"

namespace mocaplm {

// `ids`: a window's tokens from the start of a frame on; what is no bin where a bin should be is
// hidden. Differs from window_input in what a stream position is told:
//   centre         the bin on the line between the nearest known bins of the channel before and
//                  after; where one side has none, the other's extrapolation (2x[1]-x[2] from the
//                  two frames beside it, else the nearest known bin); kNoCentre where none is known
//   surprise       distance of the token from that, where it is known
//   velocity       the step between the two frames before: x[t-1]-x[t-2]
//   last_surprise  the step between the two frames after: x[t+2]-x[t+1]
ModelInput masked_input(const ModelDescription& model, const std::vector<std::int32_t>& prefix,
                        const std::vector<std::int32_t>& ids);

// Frames [first, last) of a stream, of which [from, to) are this window's own.
struct CentralWindow {
  std::size_t first, last, from, to;
};

// Windows of at most `room` frames that overlap by half and cover `frames` frames: each frame
// belongs to the one in whose middle it lies, as far as the stream's ends allow.
std::vector<CentralWindow> central_windows(std::size_t frames, std::size_t room);

}  // namespace mocaplm
