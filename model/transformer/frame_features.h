// The numbers that describe whole frames to the frame model (kFrameFeatures in model/input.h).
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

// (B, F, C) bins of whole frames -> (B, F, C * kFrameFeatures) in f32; not differentiated. A
// channel that is hidden (no bin, in all frames of the window) has zeros.
at::Tensor frame_features(const at::Tensor& bin, std::int64_t bins);

}  // namespace mocaplm
