#include "generate/kernels/ahead.h"

namespace mocaplm {

Ahead ahead_of(const Piece* first, const Piece* last, std::int64_t lead) {
  for (const Piece* piece = first; piece != last; ++piece) {
    const std::int64_t size = piece->end - piece->begin;
    if (lead < size) return {first, last, piece, piece->begin + lead, piece->end};
    lead -= size;
  }
  return {};  // the whole list is shorter
}

}  // namespace mocaplm
