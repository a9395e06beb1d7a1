#include "model/transformer/feed_forward.h"

#include "model/transformer/block.h"
#include "model/transformer/fused_parts.h"

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// What a pass leaves for the way back: x in f32, the rest in bf16 but for the norm's statistics.
struct HeldForward : torch::CustomClassHolder {
  FeedForwardWeights w;
  at::Tensor x, normed, stats, gelu, slope;
};

struct FusedFeedForward : torch::autograd::Function<FusedFeedForward> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x, at::TensorList,
                            const c10::intrusive_ptr<HeldForward>& held) {
    RECORD_USER_SCOPE("linears, forward");
    const cpu::BlockKernels& k = *cpu::block_kernels();
    HeldForward& h = *held;
    h.x = x.detach().contiguous();
    const std::int64_t rows = h.x.size(0), width = h.x.size(1), wide = h.w.up.weight.size(0);
    h.normed = half_matrix(rows, width);
    h.stats = float_matrix(rows, 2);
    h.gelu = half_matrix(rows, wide);
    h.slope = half_matrix(rows, wide);
    const at::Tensor out = float_matrix(rows, width);
    const cpu::Product up = times_transposed(h.normed, h.w.up),
                       down = times_transposed(h.gelu, h.w.down);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t) {
      k.layer_norm(floats(h.x), width, floats(h.w.ln_w), floats(h.w.ln_b), halves(h.normed),
                   floats(h.stats), a, b);
      k.linear_gelu(up, floats(h.w.up.bias), halves(h.gelu), halves(h.slope), a, b);
      k.linear_residual(down, floats(h.w.down.bias), {}, floats(h.x), floats(out), a, b);
    });
    context->saved_data["held"] = c10::IValue::make_capsule(held);
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const auto capsule = context->saved_data["held"].toCapsule();
    const HeldForward& h = static_cast<const HeldForward&>(*capsule);
    const cpu::BlockKernels& k = *cpu::block_kernels();
    const at::Tensor dout = grads[0].contiguous();
    const std::int64_t rows = h.x.size(0), width = h.x.size(1), wide = h.w.up.weight.size(0);
    const at::Tensor ddown = half_matrix(rows, width), dup = half_matrix(rows, wide),
                     dnormed = half_matrix(rows, width), dx = float_matrix(rows, width);
    const NormSums sums(rows, width);
    const cpu::Product through_down = times(ddown, h.w.down), through_up = times(dup, h.w.up);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t part) {
      RECORD_USER_SCOPE("linears, backward");
      k.to_halves(floats(dout), width, {}, halves(ddown), width, a, b);
      k.linear_times(through_down, halves(h.slope), halves(dup), a, b);
      k.linear(through_up, nullptr, halves(dnormed), a, b);
      k.layer_norm_backward(halves(dnormed), floats(h.x), floats(h.stats), width, floats(h.w.ln_w),
                            floats(dout), floats(dx), sums.weight(part), sums.bias(part), a, b);
    });
    const LinearGradient down = linear_gradient(ddown, h.gelu, h.w.down),
                         up = linear_gradient(dup, h.normed, h.w.up);
    const at::Tensor norm = sums.parts.sum(0);
    // The held weights themselves have no gradient.
    return {dx, norm[0], norm[1], up.weight, up.bias, down.weight, down.bias, at::Tensor()};
  }
};

}  // namespace

at::Tensor plain_feed_forward(const FeedForwardWeights& w, const at::Tensor& x,
                              at::ScalarType precision) {
  // The exact GELU, as in block.cpp.
  const at::Tensor up =
      at::gelu(linear_in(precision, w.up, at::layer_norm(x, {x.size(1)}, w.ln_w, w.ln_b)));
  return x + linear_in(precision, w.down, up);
}

at::Tensor feed_forward(const FeedForwardWeights& w, const at::Tensor& x,
                        at::ScalarType precision) {
  const bool on_kernels = wants_kernels(x, precision) &&
                          cpu::products_available(w.up.weight.size(1)) &&
                          cpu::products_available(w.down.weight.size(1));
  if (!on_kernels) return plain_feed_forward(w, x, precision);
  const auto held = c10::make_intrusive<HeldForward>();
  held->w = w;
  const variable_list weights = {w.ln_w,    w.ln_b,        w.up.weight,
                                 w.up.bias, w.down.weight, w.down.bias};
  return FusedFeedForward::apply(x, at::TensorList(weights), held);
}

}  // namespace mocaplm
