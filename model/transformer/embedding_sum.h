// The sum of rows of several tables, in one pass.
#pragma once

#include <vector>

#include "model/transformer/torch.h"

namespace mocaplm {

struct Lookup {
  at::Tensor table;  // (rows, C)
  at::Tensor index;  // (N), int64
};

// base (N, C) + table[index] of every lookup. Differentiable once, in base and tables; the same for
// every number of threads.
at::Tensor embedding_sum(const at::Tensor& base, const std::vector<Lookup>& lookups);

}  // namespace mocaplm
