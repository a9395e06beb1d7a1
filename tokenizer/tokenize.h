// What `mocaplm tokenize` does: fits a tokenizer on clips, writes it and, asked for, their text;
// and the way back from text to clips.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/table.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

struct TokenizeOptions {
  std::vector<std::string> inputs;  // dataset folders and motion files
  std::filesystem::path out;        // a folder, or with no text a .json file
  TokenizerConfig config;
  std::filesystem::path tokenizer;  // an existing tokenizer.json in place of fitting; "" fits
  bool text = false;                // write corpus.txt and corpus.clips.json
};

// Fits on the training split of datasets (on all clips where there is none) and on all given files,
// encodes every clip (datasets in the order of their names) and writes at the end, so that an error
// leaves `out` as it was. Returns the table of what was lost. Throws UsageError for options that
// cannot be, and DataError as the readers do, or when `out` holds another tokenizer or a text that
// is not a corpus.
Table tokenize(const TokenizeOptions& options);

// Reads a corpus and writes out/NAME.npz for each line, at the tokenizer's rate. All lines are
// checked before the first file is written; files that exist are never replaced.
Table untokenize(const std::filesystem::path& corpus, const std::filesystem::path& tokenizer,
                 const std::filesystem::path& out);

}  // namespace mocaplm
