// What `mocaplm tokenize` does: fits a tokenizer on clips, writes it and, asked for, their text;
// the way back from text to clips; and the report of many tokenizers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/table.h"
#include "motion/reading.h"
#include "tokenizer/report.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

struct TokenizeOptions {
  std::vector<std::string> inputs;  // as find_motions (motion/inputs.h) takes them
  MotionReading read;               // of files
  std::filesystem::path out;        // a folder, or with no text a .json file
  TokenizerConfig config;
  TileConfig tiles;                 // with tiles.tiles > 0 words are tiles, not frames
  PieceConfig pieces;               // with any() pieces of words are learnt: out/pieces.model
  std::filesystem::path tokenizer;  // an existing tokenizer.json in place of fitting; "" fits
  bool text = false;                // write corpus.txt and corpus.clips.json
};

// Fits on the training split of datasets (on all clips where there is none) and on all given files,
// encodes every clip (datasets in the order of their names) and writes at the end, so that an error
// leaves `out` as it was. Returns the table of what was lost. Throws UsageError for options that
// cannot be, and DataError as the readers do, or when `out` holds another tokenizer or a text that
// is not a corpus.
Table tokenize(const TokenizeOptions& options);

// Measures the tokenizer of each of `specs` (report_settings), which change options.config and
// options.tiles: fitted on the training split, measured on the test split. Without a dataset among
// the inputs, or without a test split, both are all clips, and `note` says so.
std::vector<ReportRow> tokenize_report(const TokenizeOptions& options,
                                       const std::vector<std::string>& specs, std::string& note);

// Reads a corpus and writes out/NAME.npz for each line, at the tokenizer's rate. All lines are
// checked before the first file is written; files that exist are never replaced.
Table untokenize(const std::filesystem::path& corpus, const std::filesystem::path& tokenizer,
                 const std::filesystem::path& out);

}  // namespace mocaplm
