// The page of a tokenizer: clips beside what their tokens say.
#pragma once

#include "tokenizer/tokenize.h"
#include "viewer/page.h"

namespace mocaplm {

// As many clips are shown, the first of the inputs.
constexpr std::size_t kTokenizedClips = 3;

// `tokenizer`: the file that `tokenize` wrote or read; `table`: what it said was lost.
Page tokenize_page(const TokenizeOptions& options, const std::filesystem::path& tokenizer,
                   const Table& table);

}  // namespace mocaplm
