#include "generate/kernels/linear.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace mocaplm {

namespace {

std::int64_t weights_a_word(Precision precision) {
  return precision == Precision::f32 ? 1 : precision == Precision::bf16 ? 2 : 4;
}

std::size_t size(std::int64_t count) {
  return static_cast<std::size_t>(count);
}

}  // namespace

LinearScratch::LinearScratch(std::int64_t widest)
    : prepared(size(kMaxRows * (widest + 4))),
      scale(size(kMaxRows), 1.f),
      tile(size(kMaxRows * kPanel)) {}

PackedLinear::PackedLinear(const float* weight, const float* bias, std::int64_t out,
                           std::int64_t in, Precision precision, Arena& arena)
    : precision_(precision), out_(out), in_(in) {
  const std::int64_t values = weights_a_word(precision);
  depth_ = (in + values - 1) / values;
  panels_ = (out + kPanel - 1) / kPanel;
  words_ = arena.words(panels_ * depth_ * kPanel);
  bias_.assign(size(panels_ * kPanel), 0.f);
  std::copy(bias, bias + out, bias_.begin());
  if (precision == Precision::int8) {
    scale_.assign(size(panels_ * kPanel), 0.f);
    sums_.assign(size(panels_ * kPanel), 0);
  }
  for (std::int64_t o = 0; o < out; ++o)
    precision == Precision::int8 ? pack_int8(weight + o * in, o) : pack(weight + o * in, o);
}

void PackedLinear::pack(const float* weight, std::int64_t output) {
  std::uint32_t* column = words_ + output / kPanel * depth_ * kPanel + output % kPanel;
  for (std::int64_t k = 0; k < in_; ++k) {
    if (precision_ == Precision::f32)
      std::memcpy(column + k * kPanel, weight + k, sizeof(float));
    else
      column[k / 2 * kPanel] |= static_cast<std::uint32_t>(to_bf16(weight[k])) << (k % 2 * 16);
  }
}

void PackedLinear::pack_int8(const float* weight, std::int64_t output) {
  std::uint32_t* column = words_ + output / kPanel * depth_ * kPanel + output % kPanel;
  float top = 0;
  for (std::int64_t k = 0; k < in_; ++k) top = std::max(top, std::abs(weight[k]));
  if (top == 0) return;
  scale_[size(output)] = top / 127;
  for (std::int64_t k = 0; k < in_; ++k) {
    const auto value = static_cast<std::int32_t>(std::lround(weight[k] * (127 / top)));
    sums_[size(output)] += value;
    column[k / 4 * kPanel] |= (static_cast<std::uint32_t>(value) & 0xffU) << (k % 4 * 8);
  }
}

std::int64_t PackedLinear::bytes() const {
  return panels_ * depth_ * kPanel * 4;
}

const void* PackedLinear::prepare(const Kernels& k, const float* x, std::int64_t rows,
                                  LinearScratch& scratch) const {
  if (precision_ == Precision::f32) return x;
  if (precision_ == Precision::bf16)
    k.prepare_bf16(x, rows, in_, depth_, scratch.prepared.data());
  else
    k.prepare_int8(x, rows, in_, depth_, scratch.prepared.data(), scratch.scale.data());
  return scratch.prepared.data();
}

Columns PackedLinear::share(std::int64_t part, std::int64_t parts) const {
  return {panels_ * part / parts * kPanel, panels_ * (part + 1) / parts * kPanel};
}

void PackedLinear::list(std::initializer_list<Columns> columns, std::vector<Piece>& pieces) const {
  const auto* begin = reinterpret_cast<const char*>(words_);
  for (const Columns& c : columns)
    if (c.first < c.last)
      pieces.push_back({begin + 4 * depth_ * c.first, begin + 4 * depth_ * c.last});
}

void PackedLinear::list(std::int64_t part, std::int64_t parts, std::vector<Piece>& pieces) const {
  list({share(part, parts)}, pieces);
}

void PackedLinear::apply(const float* x, float* y, std::int64_t rows, Store store,
                         LinearScratch& scratch, std::int64_t part, std::int64_t parts) const {
  apply_columns(x, y, rows, store, scratch, {share(part, parts)});
}

void PackedLinear::apply_columns(const float* x, float* y, std::int64_t rows, Store store,
                                 LinearScratch& scratch,
                                 std::initializer_list<Columns> columns) const {
  assert(rows <= kMaxRows);
  const void* prepared = nullptr;
  for (const Columns& c : columns)
    for (std::int64_t column = c.first; column < c.last && rows > 0; column += kPanel) {
      if (prepared == nullptr) prepared = prepare(kernels(), x, rows, scratch);
      apply_panel(prepared, column / kPanel, y, rows, store, scratch);
    }
}

void PackedLinear::apply_panel(const void* prepared, std::int64_t p, float* y, std::int64_t rows,
                               Store store, LinearScratch& scratch) const {
  const Kernels& k = kernels();
  const auto finish = store == Store::plain  ? k.store
                      : store == Store::gelu ? k.store_gelu
                                             : k.store_sum;
  Ahead nothing;
  Ahead& ahead = scratch.ahead != nullptr ? *scratch.ahead : nothing;
  float* tile = scratch.tile.data();
  const std::uint32_t* panel = words_ + p * depth_ * kPanel;
  const std::int64_t column = p * kPanel, count = std::min(kPanel, out_ - column);
  if (precision_ == Precision::f32)
    k.product_f32(static_cast<const float*>(prepared), rows, depth_,
                  reinterpret_cast<const float*>(panel), tile);
  else if (precision_ == Precision::bf16)
    k.product_bf16(prepared, rows, depth_, panel, tile, ahead);
  else
    k.product_int8(prepared, rows, depth_, panel, sums_.data() + column, tile, ahead);
  const float* scale = precision_ == Precision::int8 ? scale_.data() + column : nullptr;
  for (std::int64_t r = 0; r < rows; ++r)
    finish(tile + r * kPanel, scale, scratch.scale[size(r)], bias_.data() + column, count,
           y + r * out_ + column);
}

}  // namespace mocaplm
