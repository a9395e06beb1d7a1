// Dropout whose masks are drawn in parallel: LibTorch draws them on one core, one number at a time,
// which took a third of a training step.
#pragma once

#include "model/transformer/torch.h"

namespace mocaplm {

// A tensor like `like` of 0 (with probability p) and 1 / (1 - p). Follows at::manual_seed and does
// not depend on the number of threads.
at::Tensor dropout_mask(const at::Tensor& like, double p);

// A seed from LibTorch's generator, so that at::manual_seed decides it.
std::uint64_t random_seed();

}  // namespace mocaplm
