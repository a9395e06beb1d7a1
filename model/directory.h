// A model on disk:
//   config.json            ModelDescription
//   model.safetensors      the weights, f32
//   tokenizer.json         the tokenizer it speaks, whose fingerprint config.json repeats
//   pieces.model           SentencePiece's file, where the model speaks pieces; config.json repeats
//   its
//                          fingerprint
//   selftest.json          a few windows of tokens with the logits expected for them, rerun at load
//   optimizer.safetensors  AdamW's state, and
//   state.json             where training stood: only where it can be resumed
//   complete               written last: the size and hash of every file above
#pragma once

#include <filesystem>
#include <functional>

#include "model/config.h"
#include "model/input.h"
#include "model/safetensors.h"

namespace mocaplm {

struct SelfTestCase {
  ModelInput input;
  std::vector<float> logits;  // of the last position, all ids
};

struct StoredModel {
  ModelDescription description;
  TensorMap tensors;
  Json tokenizer;
  std::string pieces;  // bytes of pieces.model; empty without pieces
  std::vector<SelfTestCase> self_test;
};

// The model directory that a user's path means: the path itself, or best/ or last/ of a training
// run.
std::filesystem::path resolve_model(const std::filesystem::path& path);
// True for a folder that holds (or began to hold) a model, so that it may be replaced.
bool looks_like_model(const std::filesystem::path& path);

// Reads and verifies everything: the marker, the hashes, the tensors' names are checked by the
// users.
StoredModel load_model(const std::filesystem::path& path);
// Only config.json (for `info`).
ModelDescription load_description(const std::filesystem::path& path);
// Throws DataError when a file of the model is missing or of another length than when it was saved.
void check_complete(const std::filesystem::path& path);

// The tensors of the language model itself: a classifier's own are left out and its prefix is taken
// off.
TensorMap language_tensors(const TensorMap& tensors);

// Throws DataError when an index of the input lies outside the model's tables.
void check_input(const ModelInput& input, const ModelDescription& model, const std::string& place);
// Throws DataError when logits computed now differ from the stored ones by more than rounding:
// f32's where `tolerance` is 0; otherwise their mean distance may be this share of their spread.
void check_self_test(const SelfTestCase& expected, const std::vector<float>& logits,
                     const std::string& place, double tolerance = 0);

// Writes a whole directory beside `path` and swaps it in; `more` may add files to it before the
// marker.
void save_model(const std::filesystem::path& path, const StoredModel& model,
                const std::function<void(const std::filesystem::path&)>& more = nullptr);

}  // namespace mocaplm
