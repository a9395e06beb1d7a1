#include "model/transformer/fused_block.h"
#include "model/transformer/fused_parts.h"

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

at::Tensor rounded(const at::Tensor& given, std::int64_t stride) {
  const at::Tensor x = given.contiguous(), y = half_matrix(x.size(0), stride);
  over_rows(x.size(0), [&](std::int64_t a, std::int64_t b, std::int64_t) {
    cpu::block_kernels()->to_halves(floats(x), x.size(1), {}, halves(y), stride, a, b);
  });
  return y;
}

at::Tensor multiplied(const cpu::Product& product, std::int64_t rows, const float* bias) {
  const at::Tensor y = float_matrix(rows, product.columns);
  over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t) {
    cpu::block_kernels()->linear_f32(product, bias, floats(y), a, b);
  });
  return y;
}

struct HeldWeights : torch::CustomClassHolder {
  LinearWeights weights;
};

struct FusedOutput : torch::autograd::Function<FusedOutput> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& given, const at::Tensor&,
                            const at::Tensor&, const c10::intrusive_ptr<HeldWeights>& held) {
    RECORD_USER_SCOPE("head and loss");
    const LinearWeights& w = held->weights;
    const at::Tensor x = rounded(given, given.size(1));
    context->save_for_backward({x});
    context->saved_data["held"] = c10::IValue::make_capsule(held);
    return multiplied(times_transposed(x, w), x.size(0), floats(w.bias));
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    RECORD_USER_SCOPE("head and loss");
    const auto held = context->saved_data["held"].toCapsule();
    const LinearWeights& w = static_cast<const HeldWeights&>(*held).weights;
    const at::Tensor x = context->get_saved_variables()[0];
    const std::int64_t outputs = w.weight.size(0);
    const at::Tensor dy = rounded(grads[0], outputs + outputs % 2);  // sums go by pairs
    const LinearGradient gradient = linear_gradient(dy, x, w);
    return {multiplied(times(dy, w), x.size(0), nullptr), gradient.weight, gradient.bias,
            at::Tensor()};
  }
};

}  // namespace

at::Tensor fused_output_linear(const LinearWeights& weights, const at::Tensor& x) {
  const auto held = c10::make_intrusive<HeldWeights>();
  held->weights = weights;
  return FusedOutput::apply(x, weights.weight, weights.bias, held);
}

}  // namespace mocaplm
