// The numbers that describe whole frames to the frame model (kFrameFeatures in model/input.h).
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

// (B, F, C) bins of whole frames -> (B, F, C * kFrameFeatures) in f32; not differentiated.
at::Tensor frame_features(const at::Tensor& bin, std::int64_t bins);

}  // namespace mocaplm
