#include "model/transformer/embedding_sum.h"

#include <ATen/Parallel.h>
#include <ATen/record_function.h>

#include <algorithm>

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

constexpr std::int64_t kColumns = 16;  // of a table that one task of the backward pass fills

// Every task goes through all rows for its columns, so that no two write to the same place.
// index: (K, N); `into` (rows, C) is added to.
void scatter(const at::Tensor& grad, const at::Tensor& index, const at::Tensor& into) {
  const std::int64_t rows = grad.size(0), width = grad.size(1), lookups = index.size(0);
  const float* from = grad.data_ptr<float>();
  const auto* row = index.data_ptr<std::int64_t>();
  float* table = into.data_ptr<float>();
  at::parallel_for(0, (width + kColumns - 1) / kColumns, 1, [&](std::int64_t a, std::int64_t b) {
    const std::int64_t begin = a * kColumns, end = std::min(b * kColumns, width);
    for (std::int64_t r = 0; r < rows; ++r)
      for (std::int64_t k = 0; k < lookups; ++k) {
        float* to = table + row[k * rows + r] * width;
        for (std::int64_t c = begin; c < end; ++c) to[c] += from[r * width + c];
      }
  });
}

struct EmbeddingSum : torch::autograd::Function<EmbeddingSum> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& base_in,
                            const at::Tensor& table_in, const at::Tensor& index) {
    const at::Tensor base = base_in.contiguous(), table = table_in.contiguous();
    const std::int64_t rows = base.size(0), width = base.size(1), lookups = index.size(0);
    at::Tensor out = at::empty_like(base);
    const auto* row = index.data_ptr<std::int64_t>();
    at::parallel_for(0, rows, 256, [&](std::int64_t a, std::int64_t b) {
      for (std::int64_t r = a; r < b; ++r) {
        float* to = out.data_ptr<float>() + r * width;
        std::copy_n(base.data_ptr<float>() + r * width, width, to);
        for (std::int64_t k = 0; k < lookups; ++k) {
          const float* from = table.data_ptr<float>() + row[k * rows + r] * width;
          for (std::int64_t c = 0; c < width; ++c) to[c] += from[c];
        }
      }
    });
    context->save_for_backward({index});
    context->saved_data["rows"] = table.size(0);
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const at::Tensor grad = grads[0].contiguous();
    const at::Tensor table =
        at::zeros({context->saved_data["rows"].toInt(), grad.size(1)}, grad.options());
    scatter(grad, context->get_saved_variables()[0], table);
    return {grad, table, at::Tensor()};
  }
};

}  // namespace

at::Tensor embedding_sum(const at::Tensor& base, const std::vector<Lookup>& lookups) {
  if (base.device().is_cpu() && base.scalar_type() == at::kFloat && !lookups.empty()) {
    // The tables as one: LibTorch's functions take a fixed number of tensors.
    std::vector<at::Tensor> tables, indices;
    std::int64_t first = 0;
    for (const Lookup& lookup : lookups) {
      tables.push_back(lookup.table);
      indices.push_back(lookup.index + first);
      first += lookup.table.size(0);
    }
    return EmbeddingSum::apply(base, at::cat(tables), at::stack(indices));
  }
  at::Tensor sum = base;
  for (const Lookup& lookup : lookups) sum = sum + at::embedding(lookup.table, lookup.index);
  return sum;
}

}  // namespace mocaplm
