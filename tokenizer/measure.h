// What a tokenizer loses: the distance of clips to what their tokens decode to.
#pragma once

#include <cstdint>

#include "common/table.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// Sums over clips; degrees and centimetres.
struct TokenizerLoss {
  std::int64_t clips = 0, frames = 0, tokens = 0;
  EncodeReport encoded;
  std::int64_t components = 0, rotations = 0;
  double component_sum = 0,
         component_max = 0;  // |axis-angle component - its bin's centre|, degrees
  double rotation_sum = 0,
         rotation_max = 0;            // geodesic distance of each joint's local rotation, degrees
  double root_sum = 0, root_max = 0;  // distance of the root, cm; 0 with root = none

  // One row a quantity.
  Table table(const Tokenizer& tokenizer) const;
};

// Encodes a clip, adds what was lost to `loss` and returns the tokens.
TokenStream encode_and_measure(const Tokenizer& tokenizer, const Clip& clip, TokenizerLoss& loss);

}  // namespace mocaplm
