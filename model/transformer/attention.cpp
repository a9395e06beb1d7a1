#include "model/transformer/attention.h"

#include <ATen/Parallel.h>
#include <ATen/record_function.h>

#include <cmath>
#include <limits>
#include <vector>

#include "model/transformer/cpu/attention.h"
#include "model/transformer/dropout.h"
#include "model/transformer/fused_parts.h"

namespace mocaplm {

namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

// Queries are taken in blocks of this many; a block of queries needs only the keys up to its end,
// so the work is a little over half of the full square.
constexpr std::int64_t kBlock = 128;

struct Block {
  std::int64_t begin, end;
};

std::vector<Block> query_blocks(std::int64_t length, std::int64_t free) {
  std::vector<Block> blocks;
  for (std::int64_t begin = 0; begin < length;) {
    std::int64_t end = std::min(begin + kBlock, length);
    if (length - end < free)
      end = length;  // free queries share the last block, which sees all keys
    blocks.push_back({begin, end});
    begin = end;
  }
  return blocks;
}

// -inf where a query of the block must not see a key of the block's own span.
at::Tensor block_mask(const Block& block, std::int64_t length, std::int64_t free,
                      const at::TensorOptions& options) {
  const std::int64_t size = block.end - block.begin;
  at::Tensor mask =
      at::full({size, size}, -std::numeric_limits<float>::infinity(), options).triu_(1);
  const std::int64_t first_free = std::max(length - free, block.begin) - block.begin;
  if (free > 0 && first_free < size) mask.slice(0, first_free).zero_();
  return mask;
}

// Forward keeps the softmax of each block of queries; backward is the product rule on those blocks.
struct BlockedAttention : torch::autograd::Function<BlockedAttention> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& q, const at::Tensor& k,
                            const at::Tensor& v, std::int64_t free, double dropout) {
    const std::int64_t length = q.size(2);
    const double scale = 1 / std::sqrt(static_cast<double>(q.size(3)));
    const at::Tensor scaled = q * scale;
    at::Tensor out = at::empty_like(q);
    variable_list saved = {scaled, k, v};
    for (const Block& block : query_blocks(length, free)) {
      at::Tensor scores = at::matmul(scaled.slice(2, block.begin, block.end),
                                     k.slice(2, 0, block.end).transpose(2, 3));
      scores.slice(3, block.begin, block.end) += block_mask(block, length, free, scores.options());
      at::Tensor weights = at::_softmax(scores, -1, false);
      at::Tensor kept;
      if (dropout > 0) kept = dropout_mask(weights, dropout);
      out.slice(2, block.begin, block.end)
          .copy_(at::matmul(kept.defined() ? weights * kept : weights, v.slice(2, 0, block.end)));
      saved.push_back(weights);
      saved.push_back(kept);
    }
    context->save_for_backward(saved);
    context->saved_data["free"] = free;
    context->saved_data["scale"] = scale;
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    const variable_list saved = context->get_saved_variables();
    const at::Tensor &scaled = saved[0], &k = saved[1], &v = saved[2];
    const at::Tensor grad = grads[0].contiguous();
    at::Tensor dq = at::empty_like(scaled), dk = at::zeros_like(k), dv = at::zeros_like(v);
    std::size_t index = 3;
    for (const Block& block : query_blocks(scaled.size(2), context->saved_data["free"].toInt())) {
      const at::Tensor weights = saved[index], kept = saved[index + 1];
      index += 2;
      const at::Tensor dout = grad.slice(2, block.begin, block.end);
      const at::Tensor keys = k.slice(2, 0, block.end), values = v.slice(2, 0, block.end);
      const at::Tensor used = kept.defined() ? weights * kept : weights;
      dv.slice(2, 0, block.end) += at::matmul(used.transpose(2, 3), dout);
      at::Tensor dweights = at::matmul(dout, values.transpose(2, 3));
      if (kept.defined()) dweights *= kept;
      const at::Tensor dscores =
          at::_softmax_backward_data(dweights, weights, -1, weights.scalar_type());
      dq.slice(2, block.begin, block.end).copy_(at::matmul(dscores, keys));
      dk.slice(2, 0, block.end) +=
          at::matmul(dscores.transpose(2, 3), scaled.slice(2, block.begin, block.end));
    }
    return {dq.mul_(context->saved_data["scale"].toDouble()), dk, dv, at::Tensor(), at::Tensor()};
  }
};

// The kernels of cpu/ as a differentiable function; what is saved is the input, the output and one
// number a query.
struct FusedAttention : torch::autograd::Function<FusedAttention> {
  static at::Tensor forward(AutogradContext* context, const at::Tensor& given, std::int64_t free,
                            double dropout) {
    RECORD_USER_SCOPE("attention, forward");
    const at::Tensor qkv = given.contiguous();
    cpu::AttentionShape shape{qkv.size(0), qkv.size(1), qkv.size(3), qkv.size(4), free, dropout, 0};
    if (dropout > 0) shape.seed = random_seed();
    const at::Tensor out =
        at::empty({shape.batch, shape.length, shape.heads, shape.width}, qkv.options());
    const at::Tensor log_sum = at::empty({shape.batch, shape.heads, shape.length}, at::kFloat);
    at::parallel_for(0, shape.batch * shape.heads, 1, [&](std::int64_t first, std::int64_t last) {
      cpu::attention_forward(shape, halves(qkv), halves(out), log_sum.data_ptr<float>(), first,
                             last);
    });
    context->save_for_backward({qkv, out, log_sum});
    context->saved_data["free"] = free;
    context->saved_data["dropout"] = dropout;
    context->saved_data["seed"] = static_cast<std::int64_t>(shape.seed);
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& grads) {
    RECORD_USER_SCOPE("attention, backward");
    const variable_list saved = context->get_saved_variables();
    const at::Tensor &qkv = saved[0], &out = saved[1], &log_sum = saved[2];
    const at::Tensor dout = grads[0].contiguous(), dqkv = at::empty_like(qkv);
    const cpu::AttentionShape shape{
        qkv.size(0),
        qkv.size(1),
        qkv.size(3),
        qkv.size(4),
        context->saved_data["free"].toInt(),
        context->saved_data["dropout"].toDouble(),
        static_cast<std::uint64_t>(context->saved_data["seed"].toInt())};
    at::parallel_for(0, shape.batch * shape.heads, 1, [&](std::int64_t first, std::int64_t last) {
      cpu::attention_backward(shape, halves(qkv), halves(out), log_sum.data_ptr<float>(),
                              halves(dout), halves(dqkv), first, last);
    });
    return {dqkv, at::Tensor(), at::Tensor()};
  }
};

}  // namespace

at::Tensor packed_causal_attention(const at::Tensor& qkv, std::int64_t free, double dropout) {
  if (qkv.device().is_cpu() && qkv.scalar_type() == at::kBFloat16 &&
      cpu::attention_available(qkv.size(4)))
    return FusedAttention::apply(qkv, free, dropout);
  // LibTorch's products of bf16 round every sum on the way where the processor has none of its own,
  // and take minutes.
  if (qkv.device().is_cpu() && qkv.scalar_type() == at::kBFloat16)
    return packed_causal_attention(qkv.to(at::kFloat), free, dropout).to(at::kBFloat16);
  // (3, B, H, T, D), one copy that makes every product contiguous
  const at::Tensor turned = qkv.permute({2, 0, 3, 1, 4}).contiguous();
  return causal_attention(turned[0], turned[1], turned[2], free, dropout).transpose(1, 2);
}

at::Tensor causal_attention(const at::Tensor& q, const at::Tensor& k, const at::Tensor& v,
                            std::int64_t free, double dropout) {
#if MOCAPLM_TORCH_AT_LEAST(2, 1)
  if (free == 0) return at::scaled_dot_product_attention(q, k, v, {}, dropout, /*is_causal=*/true);
#endif
  return BlockedAttention::apply(q, k, v, free, dropout);
}

}  // namespace mocaplm
