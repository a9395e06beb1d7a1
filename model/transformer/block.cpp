#include "model/transformer/block.h"

#include "model/transformer/attention.h"
#include "model/transformer/cpu/block.h"
#include "model/transformer/dropout.h"
#include "model/transformer/fused_block.h"

namespace mocaplm {

namespace {

at::Tensor drop(const at::Tensor& x, double p) {
  return p > 0 ? x * dropout_mask(x, p) : x;
}

}  // namespace

at::Tensor linear_in(at::ScalarType type, const LinearWeights& w, const at::Tensor& x) {
  return at::linear(x.to(type), w.weight.to(type), w.bias.to(type));
}

bool wants_kernels(const at::Tensor& x, at::ScalarType precision) {
  return precision == at::kBFloat16 && x.device().is_cpu() && x.scalar_type() == at::kFloat;
}

at::Tensor plain_block(const BlockWeights& w, const at::Tensor& x, const BlockOptions& o) {
  const std::int64_t batch = x.size(0), length = x.size(1), width = x.size(2);
  const at::Tensor qkv = linear_in(o.precision, w.qkv, at::layer_norm(x, {width}, w.ln1_w, w.ln1_b))
                             .view({batch, length, 3, o.heads, width / o.heads});
  const at::Tensor attended =
      packed_causal_attention(qkv, o.free, o.dropout).reshape({batch, length, width});
  const at::Tensor middle = x + drop(linear_in(o.precision, w.proj, attended), o.dropout);
  // The exact GELU: in bf16 LibTorch 1.13's tanh formula takes eight times as long on a CPU.
  const at::Tensor up =
      at::gelu(linear_in(o.precision, w.up, at::layer_norm(middle, {width}, w.ln2_w, w.ln2_b)));
  return middle + drop(linear_in(o.precision, w.down, up), o.dropout);
}

at::Tensor transformer_block(const BlockWeights& w, const at::Tensor& x, const BlockOptions& o) {
  return wants_kernels(x, o.precision) && cpu::block_available(x.size(2), o.heads)
             ? fused_block(w, x, o)
             : plain_block(w, x, o);
}

at::Tensor output_linear(const LinearWeights& w, const at::Tensor& x, at::ScalarType precision) {
  return wants_kernels(x, precision) && cpu::products_available(x.size(1))
             ? fused_output_linear(w, x)
             : at::linear(x, w.weight, w.bias);
}

}  // namespace mocaplm
