// Fine-tunes a pre-trained model into a classifier and measures it beside LDA and the majority
// class.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "classify/config.h"
#include "classify/scores.h"

namespace mocaplm {

struct ClassifyOptions {
  std::filesystem::path model, data;
  std::filesystem::path out;  // optional: the classifier as a model directory, the tables as JSON
  std::string split = "test";
  ClassifyConfig config;
  std::string device = "auto";
  int threads = 0;
};

struct ClassifyResult {
  std::vector<Task> tasks;
  std::vector<MethodScores> methods;  // majority class, LDA, transformer
  std::size_t window_frames = 0;
  double fps = 0;
  double seconds = 0;
  bool procedural = false;
};

// Throws UsageError or DataError before any work when something does not fit together.
ClassifyResult classify(const ClassifyOptions& options);

// Windows, clips, balanced, and one confusion matrix a label (of the transformer).
std::vector<Table> classify_tables(const ClassifyResult& result);

}  // namespace mocaplm
