// A linear layer with its weights packed once, in the precision that decoding reads them in.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <vector>

#include "generate/kernels/kernels.h"
#include "generate/kernels/memory.h"

namespace mocaplm {

// What one thread needs to apply layers of up to `widest` inputs to up to kMaxRows rows.
struct LinearScratch {
  explicit LinearScratch(std::int64_t widest);

  std::vector<std::uint32_t> prepared;  // the rows in the layer's precision
  std::vector<float> scale;             // of each row (int8)
  std::vector<float> tile;              // (kMaxRows, kPanel)
  Ahead* ahead = nullptr;               // where the thread is ahead of itself, if anywhere
};

enum class Store { plain, gelu, sum };  // y = W x + b, GELU(W x + b), y + W x + b

struct Columns {
  std::int64_t first, last;
};

// y = W x + b with W (out, in), packed in panels of kPanel outputs so that decoding one row streams
// through memory in order.
//
// A panel holds, for each depth step, one 32-bit word an output: one f32, two bf16 or four int8
// values of W along `in`.
class PackedLinear {
 public:
  PackedLinear() = default;
  // The arena keeps the weights and must outlive this.
  PackedLinear(const float* weight, const float* bias, std::int64_t out, std::int64_t in,
               Precision precision, Arena& arena);

  // x: (rows, in), y: (rows, out), rows <= kMaxRows. Computes the share of the outputs that falls
  // to `part` of `parts`; every output is the same whatever the parts.
  void apply(const float* x, float* y, std::int64_t rows, Store store, LinearScratch& scratch,
             std::int64_t part = 0, std::int64_t parts = 1) const;

  // The same for some columns of the output, which begin and end with panels.
  void apply_columns(const float* x, float* y, std::int64_t rows, Store store,
                     LinearScratch& scratch, std::initializer_list<Columns> columns) const;
  // Adds the weights that apply, or apply_columns, reads.
  void list(std::int64_t part, std::int64_t parts, std::vector<Piece>& pieces) const;
  void list(std::initializer_list<Columns> columns, std::vector<Piece>& pieces) const;

  std::int64_t in() const { return in_; }
  std::int64_t out() const { return out_; }
  std::int64_t bytes() const;  // that one pass over the weights reads

 private:
  const void* prepare(const Kernels& k, const float* x, std::int64_t rows,
                      LinearScratch& scratch) const;
  Columns share(std::int64_t part, std::int64_t parts) const;
  void apply_panel(const void* prepared, std::int64_t panel, float* y, std::int64_t rows,
                   Store store, LinearScratch& scratch) const;
  void pack(const float* weight, std::int64_t output);
  void pack_int8(const float* weight, std::int64_t output);

  Precision precision_ = Precision::f32;
  std::int64_t out_ = 0, in_ = 0, depth_ = 0, panels_ = 0;
  std::uint32_t* words_ = nullptr;   // [panel][depth][kPanel]
  std::vector<float> bias_, scale_;  // padded to whole panels; a scale an output (int8)
  std::vector<std::int32_t> sums_;   // of each output's 8-bit weights
};

// The upper half of an f32, rounded to the nearest (ties to even).
inline std::uint16_t to_bf16(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return static_cast<std::uint16_t>((bits + 0x7fffU + (bits >> 16 & 1U)) >> 16);
}

}  // namespace mocaplm
