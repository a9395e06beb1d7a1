#include "model/transformer/fused_block.h"

#include "model/transformer/cpu/attention.h"
#include "model/transformer/dropout.h"
#include "model/transformer/fused_parts.h"

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// One pass through a block: M = B T rows of width C.
struct Pass : torch::CustomClassHolder {
  Pass(const BlockWeights& weights, const at::Tensor& given, const BlockOptions& o)
      : w(weights),
        shape{given.size(0), given.size(1), o.heads, given.size(2) / o.heads, o.free, o.dropout, 0},
        rows(given.size(0) * given.size(1)),
        width(given.size(2)),
        x(given.detach().contiguous().view({rows, width})) {
    if (o.dropout <= 0) return;
    shape.seed = random_seed();  // in the order of plain_block
    proj_mask = {o.dropout, random_seed()};
    down_mask = {o.dropout, random_seed()};
  }

  at::Tensor forward(bool differentiable) {
    const cpu::BlockKernels& k = *cpu::block_kernels();
    n1 = half_matrix(rows, width);
    stats1 = float_matrix(rows, 2);
    qkv = half_matrix(rows, 3 * width);
    const cpu::Product to_qkv = times_transposed(n1, w.qkv);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t) {
      normalise(k, x, w.ln1_w, w.ln1_b, n1, stats1, a, b);
      RECORD_USER_SCOPE("linears, forward");
      k.linear(to_qkv, floats(w.qkv.bias), halves(qkv), a, b);
    });
    attend();
    middle = float_matrix(rows, width);
    n2 = half_matrix(rows, width);
    stats2 = float_matrix(rows, 2);
    gelu = half_matrix(rows, 4 * width);
    if (differentiable) slope = half_matrix(rows, 4 * width);
    const at::Tensor out = float_matrix(rows, width);
    const cpu::Product proj = times_transposed(attended, w.proj), up = times_transposed(n2, w.up),
                       down = times_transposed(gelu, w.down);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t) {
      {
        RECORD_USER_SCOPE("linears, forward");
        k.linear_residual(proj, floats(w.proj.bias), proj_mask, floats(x), floats(middle), a, b);
      }
      normalise(k, middle, w.ln2_w, w.ln2_b, n2, stats2, a, b);
      RECORD_USER_SCOPE("linears, forward");
      k.linear_gelu(up, floats(w.up.bias), halves(gelu), differentiable ? halves(slope) : nullptr,
                    a, b);
      k.linear_residual(down, floats(w.down.bias), down_mask, floats(middle), floats(out), a, b);
    });
    return out;
  }

  // dout (M, C) -> the gradients of x and of the weights in their order (weight_list).
  variable_list backward(const at::Tensor& dout) {
    const at::Tensor ddown = half_matrix(rows, width), dup = half_matrix(rows, 4 * width),
                     dproj = half_matrix(rows, width), dattended = half_matrix(rows, width),
                     dx = float_matrix(rows, width);
    const NormSums sums2 = back_to_attention(dout, {ddown, dup, dproj, dattended, dx});
    const LinearGradient down = linear_gradient(ddown, gelu, w.down),
                         up = linear_gradient(dup, n2, w.up),
                         proj = linear_gradient(dproj, attended, w.proj);
    const at::Tensor dqkv = attend_backward(dattended);
    const LinearGradient from_qkv = linear_gradient(dqkv, n1, w.qkv);
    const NormSums sums1 = back_to_input(dqkv, dx);
    const at::Tensor norm1 = sums1.parts.sum(0), norm2 = sums2.parts.sum(0);
    return {dx,       norm1[0], norm1[1],  from_qkv.weight, from_qkv.bias, proj.weight, proj.bias,
            norm2[0], norm2[1], up.weight, up.bias,         down.weight,   down.bias};
  }

  const BlockWeights w;
  cpu::AttentionShape shape;
  cpu::DropoutMask proj_mask, down_mask;
  std::int64_t rows, width;

 private:
  struct Back {
    at::Tensor ddown, dup, dproj, dattended, dx;
  };

  static void normalise(const cpu::BlockKernels& k, const at::Tensor& from,
                        const at::Tensor& weight, const at::Tensor& bias, const at::Tensor& to,
                        const at::Tensor& stats, std::int64_t a, std::int64_t b) {
    RECORD_USER_SCOPE("layer norm");
    k.layer_norm(floats(from), from.size(1), floats(weight), floats(bias), halves(to),
                 floats(stats), a, b);
  }

  void attend() {
    RECORD_USER_SCOPE("attention, forward");
    attended = half_matrix(rows, width);
    log_sum = float_matrix(shape.batch * shape.heads, shape.length);
    in_turn(shape.batch * shape.heads, [&](std::int64_t pair) {
      cpu::attention_forward(shape, halves(qkv), halves(attended), floats(log_sum), pair, pair + 1);
    });
  }

  at::Tensor attend_backward(const at::Tensor& dattended) const {
    RECORD_USER_SCOPE("attention, backward");
    const at::Tensor dqkv = half_matrix(rows, 3 * width);
    in_turn(shape.batch * shape.heads, [&](std::int64_t pair) {
      cpu::attention_backward(shape, halves(qkv), halves(attended), floats(log_sum),
                              halves(dattended), halves(dqkv), pair, pair + 1);
    });
    return dqkv;
  }

  // From the block's end to what attention gave; dx becomes the gradient of `middle`.
  NormSums back_to_attention(const at::Tensor& dout, const Back& to) const {
    const cpu::BlockKernels& k = *cpu::block_kernels();
    const NormSums sums(rows, width);
    const at::Tensor dn2 = half_matrix(rows, width);
    const cpu::Product through_down = times(to.ddown, w.down), through_up = times(to.dup, w.up),
                       through_proj = times(to.dproj, w.proj);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t part) {
      {
        RECORD_USER_SCOPE("linears, backward");
        k.to_halves(floats(dout), width, down_mask, halves(to.ddown), width, a, b);
        k.linear_times(through_down, halves(slope), halves(to.dup), a, b);
        k.linear(through_up, nullptr, halves(dn2), a, b);
      }
      {
        RECORD_USER_SCOPE("layer norm");
        k.layer_norm_backward(halves(dn2), floats(middle), floats(stats2), width, floats(w.ln2_w),
                              floats(dout), floats(to.dx), sums.weight(part), sums.bias(part), a,
                              b);
      }
      RECORD_USER_SCOPE("linears, backward");
      k.to_halves(floats(to.dx), width, proj_mask, halves(to.dproj), width, a, b);
      k.linear(through_proj, nullptr, halves(to.dattended), a, b);
    });
    return sums;
  }

  // dx: the gradient of `middle` becomes that of x.
  NormSums back_to_input(const at::Tensor& dqkv, const at::Tensor& dx) const {
    const cpu::BlockKernels& k = *cpu::block_kernels();
    const NormSums sums(rows, width);
    const at::Tensor dn1 = half_matrix(rows, width);
    const cpu::Product through_qkv = times(dqkv, w.qkv);
    over_rows(rows, [&](std::int64_t a, std::int64_t b, std::int64_t part) {
      {
        RECORD_USER_SCOPE("linears, backward");
        k.linear(through_qkv, nullptr, halves(dn1), a, b);
      }
      RECORD_USER_SCOPE("layer norm");
      k.layer_norm_backward(halves(dn1), floats(x), floats(stats1), width, floats(w.ln1_w),
                            floats(dx), floats(dx), sums.weight(part), sums.bias(part), a, b);
    });
    return sums;
  }

  // (M, ...): the input in f32, what each step left in bf16, and the slope of the GELU.
  at::Tensor x, n1, stats1, qkv, attended, log_sum, middle, n2, stats2, gelu, slope;
};

variable_list weight_list(const BlockWeights& w) {
  return {w.ln1_w, w.ln1_b, w.qkv.weight, w.qkv.bias, w.proj.weight, w.proj.bias,
          w.ln2_w, w.ln2_b, w.up.weight,  w.up.bias,  w.down.weight, w.down.bias};
}

struct FusedBlock : torch::autograd::Function<FusedBlock> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& x, at::TensorList,
                            const c10::intrusive_ptr<Pass>& pass) {
    context->saved_data["pass"] = c10::IValue::make_capsule(pass);
    return pass->forward(true).view(x.sizes());
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const auto held = context->saved_data["pass"].toCapsule();
    auto& pass = static_cast<Pass&>(*held);
    variable_list out = pass.backward(grads[0].contiguous().view({pass.rows, pass.width}));
    out[0] = out[0].view(grads[0].sizes());
    out.emplace_back();  // the pass itself has none
    return out;
  }
};

}  // namespace

at::Tensor fused_block(const BlockWeights& w, const at::Tensor& x, const BlockOptions& o) {
  const auto pass = c10::make_intrusive<Pass>(w, x, o);
  if (!at::GradMode::is_enabled()) return pass->forward(false).view(x.sizes());
  const variable_list weights = weight_list(w);
  return FusedBlock::apply(x, at::TensorList(weights), pass);
}

}  // namespace mocaplm
