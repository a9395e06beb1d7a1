// The keys and values of one layer, of several sequences, laid out as attention reads them.
#pragma once

#include <cstdint>

#include "generate/kernels/kernels.h"
#include "generate/kernels/memory.h"

namespace mocaplm {

// For each (sequence, head), with W values a head and words of one f32 or two bf16:
//   keys    [position / 16][W, or pairs of W][position % 16]
//   values  [position, or pair of positions][W rounded up to 16]
class KeyValueCache {
 public:
  KeyValueCache() = default;
  // The arena keeps the memory and must outlive this.
  KeyValueCache(std::int64_t sequences, std::int64_t heads, std::int64_t capacity,
                std::int64_t width, Precision precision, Arena& arena);

  // Puts key and value (width) of one head at a position; the positions before it must be there.
  void store(std::int64_t sequence, std::int64_t head, std::int64_t position, const float* key,
             const float* value);

  // out (width) = softmax(query . keys / sqrt(width)) values over the first `count` positions.
  // `scratch`: scratch_size() floats.
  void attend(std::int64_t sequence, std::int64_t head, std::int64_t count, const float* query,
              float* scratch, float* out) const;
  std::int64_t scratch_size() const { return padded_capacity_ + width_; }

  std::int64_t bytes(std::int64_t count) const;  // that attending to `count` positions reads

 private:
  std::uint32_t* keys(std::int64_t sequence, std::int64_t head) const;
  std::uint32_t* values(std::int64_t sequence, std::int64_t head) const;

  bool halves_ = false;  // bf16
  std::int64_t heads_ = 0, width_ = 0, padded_width_ = 0, padded_capacity_ = 0;
  std::int64_t key_words_ = 0, value_words_ = 0;  // of one head
  std::uint32_t* words_ = nullptr;
};

}  // namespace mocaplm
