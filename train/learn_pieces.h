// Pieces for a model, learnt by another process: SentencePiece's library and LibTorch each bring a
// protobuf of their own and cannot live in one, so `mocaplm tokenize`, which has the one, is asked.
#pragma once

#include <filesystem>
#include <string>

#include "tokenizer/pieces.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// SentencePiece's file of pieces of the training split of the dataset `data`, as `tokenizer` writes
// it. `program` is a mocaplm; empty: the one beside this program. Throws UsageError or DataError
// with what that program said when it does not end well.
std::string learn_model_pieces(const PieceConfig& config, const Tokenizer& tokenizer,
                               const std::filesystem::path& data,
                               const std::filesystem::path& program = {});

}  // namespace mocaplm
