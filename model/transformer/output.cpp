#include "model/transformer/output.h"

#include <ATen/Parallel.h>
#include <ATen/record_function.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/input.h"
#include "model/transformer/cpu/block.h"

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// Rows of plain pointers: what one row of the fused pass needs.
struct Row {
  const float* absolute;
  const float* offsets;  // null: none
  std::int64_t vocabulary, reach, centre;
  BinRange bins;

  std::int64_t offset(std::int64_t bin) const {
    return std::clamp(bin - centre, -reach, reach) + reach;
  }
  bool shifted() const { return offsets != nullptr && centre != kNoCentre; }

  void logits(float* out) const {
    std::copy(absolute, absolute + vocabulary, out);
    if (!shifted()) return;
    for (std::int64_t b = 0; b < bins.count; ++b) out[bins.first + b] += offsets[offset(b)];
  }
};

// Softmax in place; returns the log of the sum of exponentials.
float plain_softmax(float* z, std::int64_t n) {
  const float top = *std::max_element(z, z + n);
  float sum = 0;
  for (std::int64_t i = 0; i < n; ++i) sum += z[i] = std::exp(z[i] - top);
  for (std::int64_t i = 0; i < n; ++i) z[i] /= sum;
  return top + std::log(sum);
}

struct FusedCrossEntropy : torch::autograd::Function<FusedCrossEntropy> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& absolute_in,
                            const at::Tensor& offsets_in, const at::Tensor& centre_in,
                            const at::Tensor& target_in, std::int64_t first, std::int64_t count) {
    RECORD_USER_SCOPE("head and loss");
    const at::Tensor absolute = absolute_in.contiguous(), centre = centre_in.contiguous(),
                     target = target_in.contiguous(), offsets = offsets_in.contiguous();
    const std::int64_t rows = absolute.size(0), vocabulary = absolute.size(1);
    const std::int64_t width = offsets.size(1);
    at::Tensor loss = at::zeros({rows}, absolute.options());
    at::Tensor dabsolute = at::empty_like(absolute);
    at::Tensor doffsets = width > 0 ? at::zeros_like(offsets) : at::Tensor();
    const auto* centres = centre.data_ptr<std::int64_t>();
    const auto* targets = target.data_ptr<std::int64_t>();
    const cpu::BlockKernels* kernels = cpu::block_kernels();
    const auto softmax = kernels != nullptr ? kernels->softmax : plain_softmax;
    at::parallel_for(0, rows, 64, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        float* z = dabsolute.data_ptr<float>() + i * vocabulary;
        if (targets[i] < 0) {
          std::fill(z, z + vocabulary, 0.f);
          continue;
        }
        const Row row{absolute.data_ptr<float>() + i * vocabulary,
                      width > 0 ? offsets.data_ptr<float>() + i * width : nullptr,
                      vocabulary,
                      (width - 1) / 2,
                      centres[i],
                      {first, count}};
        row.logits(z);
        const float wanted = z[targets[i]];
        loss.data_ptr<float>()[i] = softmax(z, vocabulary) - wanted;
        z[targets[i]] -= 1;  // z is now the gradient
        if (!row.shifted()) continue;
        float* d = doffsets.data_ptr<float>() + i * width;
        for (std::int64_t b = 0; b < count; ++b) d[row.offset(b)] += z[first + b];
      }
    });
    context->save_for_backward({dabsolute, doffsets});
    return loss;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    RECORD_USER_SCOPE("head and loss");
    const at::Tensor scale = grads[0].unsqueeze(1);
    return {saved[0] * scale, saved[1].defined() ? saved[1] * scale : at::Tensor(),
            at::Tensor(),     at::Tensor(),
            at::Tensor(),     at::Tensor()};
  }
};

}  // namespace

at::Tensor combined_logits(const at::Tensor& absolute, const at::Tensor& offsets,
                           const at::Tensor& centre, const BinRange& bins) {
  if (!offsets.defined()) return absolute;
  const std::int64_t reach = (offsets.size(1) - 1) / 2;
  const at::Tensor bin = at::arange(bins.count, centre.options()).unsqueeze(0);
  const at::Tensor index = (bin - centre.unsqueeze(1)).clamp(-reach, reach) + reach;
  const at::Tensor known = (centre != kNoCentre).unsqueeze(1).to(absolute.scalar_type());
  const at::Tensor shifted = offsets.gather(1, index) * known;
  return absolute +
         at::constant_pad_nd(shifted, {bins.first, absolute.size(1) - bins.first - bins.count});
}

at::Tensor combined_cross_entropy(const at::Tensor& absolute, const at::Tensor& offsets,
                                  const at::Tensor& centre, const at::Tensor& target,
                                  const BinRange& bins) {
  if (absolute.device().is_cpu() && absolute.scalar_type() == at::kFloat)
    return FusedCrossEntropy::apply(
        absolute,
        // LibTorch's functions take no undefined tensors.
        offsets.defined() ? offsets : at::empty({absolute.size(0), 0}, absolute.options()), centre,
        target, bins.first, bins.count);
  const at::Tensor logits = combined_logits(absolute, offsets, centre, bins);
  const at::Tensor wanted =
      at::log_softmax(logits, -1).gather(1, target.clamp_min(0).unsqueeze(1)).squeeze(1);
  return -wanted * (target >= 0).to(wanted.scalar_type());
}

}  // namespace mocaplm
