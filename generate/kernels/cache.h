// The keys and values of one layer, of several sequences, laid out as attention reads them.
#pragma once

#include <cstdint>
#include <vector>

#include "generate/kernels/kernels.h"
#include "generate/kernels/memory.h"

namespace mocaplm {

// For each (sequence, head), with W values a head and words of one f32, two bf16 or four 8-bit
// numbers:
//   keys    [position / 16][W, or pairs or quadruples of W][position % 16]
//   values  [position, or pair or quadruple of positions][W rounded up to 16]
// and, for 8-bit numbers, three numbers a position: the scales of its key and of its value, and 128
// times the sum of the key's bytes. int8 has 8-bit numbers where there is a kernel for them (VNNI),
// else bf16.
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
              float* scratch, float* out, Ahead* ahead = nullptr) const;
  // Adds what attending reads.
  void list(std::int64_t sequence, std::int64_t head, std::int64_t count,
            std::vector<Piece>& pieces) const;
  std::int64_t scratch_size() const { return 2 * padded_capacity_ + 3 * padded_width_; }

  std::int64_t bytes(std::int64_t count) const;  // that attending to `count` positions reads

 private:
  std::uint32_t* keys(std::int64_t sequence, std::int64_t head) const;
  std::uint32_t* values(std::int64_t sequence, std::int64_t head) const;
  float* key_scales(std::int64_t sequence, std::int64_t head) const;
  ByteHead byte_head(std::int64_t sequence, std::int64_t head) const;

  std::int64_t packed_ = 1;  // values a word
  std::int64_t heads_ = 0, width_ = 0, padded_width_ = 0, padded_capacity_ = 0;
  std::int64_t depth_ = 0;                        // words of a key
  std::int64_t key_words_ = 0, value_words_ = 0;  // of one head
  std::int64_t head_words_ = 0;                   // with the numbers of each position
  std::uint32_t* words_ = nullptr;
};

}  // namespace mocaplm
