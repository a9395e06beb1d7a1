// What a thread will read, asked for before it is needed: weights, keys and values are known in
// advance, and while they are computed with, waited for at a barrier or put through a softmax,
// nothing else would keep the memory busy.
#pragma once

#include <cstdint>

namespace mocaplm {

struct Piece {  // of memory, aligned to cache lines
  const char *begin, *end;
};

// A place in a list of pieces that are read in order, again and again. What reads a cache line of
// them asks for the line at this place and moves it on, so that it stays as far ahead as it was at
// the start; two readings of a list need not agree to the byte. Without pieces nothing is asked
// for.
struct Ahead {
  const Piece *first = nullptr, *last = nullptr, *piece = nullptr;
  const char *at = nullptr, *end = nullptr;
};

// The place `lead` bytes after the start of the list [first, last).
Ahead ahead_of(const Piece* first, const Piece* last, std::int64_t lead);

}  // namespace mocaplm
