#include "model/transformer/packed_weights.h"

#include <ATen/Parallel.h>
#include <ATen/record_function.h>

#include "model/transformer/cpu/block.h"

namespace mocaplm {

const at::Tensor& PackedWeights::made(const at::Tensor& weight, Copy& copy, bool transposed) {
  const auto version = static_cast<std::int64_t>(weight._version());
  if (copy.values.defined() && copy.data == weight.data_ptr() && copy.version == version)
    return copy.values;
  RECORD_USER_SCOPE("packing");
  const std::int64_t rows = weight.size(0), columns = weight.size(1);
  const std::int64_t size =
      transposed ? cpu::packed_size(columns, rows) : cpu::packed_size(rows + rows % 2, columns);
  if (!copy.values.defined()) copy.values = at::empty({size}, at::kBFloat16);
  auto* to = reinterpret_cast<cpu::bf16*>(copy.values.data_ptr<at::BFloat16>());
  const cpu::BlockKernels& kernels = *cpu::block_kernels();
  const auto pack = transposed ? kernels.pack_transposed : kernels.pack;
  at::parallel_for(0, cpu::packed_panels(transposed ? rows : columns), 1,
                   [&](std::int64_t first, std::int64_t last) {
                     pack(weight.data_ptr<float>(), rows, columns, to, first, last);
                   });
  copy.data = weight.data_ptr();
  copy.version = version;
  return copy.values;
}

}  // namespace mocaplm
