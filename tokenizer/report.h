// `mocaplm tokenize --report`: many tokenizers on the same clips, a row each, as in the thesis's
// Tables 4.1 and 4.2.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "tokenizer/pieces.h"
#include "tokenizer/word_measure.h"

namespace mocaplm {

struct ReportSetting {
  std::string name;
  TokenizerConfig frames;
  TileConfig tiles;
  PieceConfig pieces;
};

// The settings that each of `specs` changes in `base`: "tiles:60,keep:0.1,pca:42,lapped", lists
// with + ("joints:pelvis+left_leg"), or the name of a .json file with a list of objects. Tiles do
// not tell the root unless the spec, or `base` by "absolute", says so. Throws UsageError naming
// what is wrong.
std::vector<ReportSetting> report_settings(const std::vector<std::string>& specs,
                                           const ReportSetting& base);

// Pieces of what `tokenizer` writes of clips given one at a time.
Pieces learn_pieces(const PieceConfig& config, const AnyTokenizer& tokenizer, std::size_t count,
                    const std::function<Clip(std::size_t)>& clip);

struct ReportRow {
  ReportSetting setting;
  WordMeasure measure;
};

// Fits each setting's tokenizer on `fitted` and measures it on `held_out` (clips at their own
// rates).
std::vector<ReportRow> report(const std::vector<ReportSetting>& settings,
                              const std::vector<Clip>& fitted, const std::vector<Clip>& held_out);

Table report_table(const std::vector<ReportRow>& rows);

}  // namespace mocaplm
