// What a classifier says of windows and, once stored, of any clip.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "classify/classifier.h"
#include "common/table.h"
#include "motion/reading.h"

namespace mocaplm {

// `frames` frames of each place, ids as targets: (places, 1 + frames * tokens a frame).
Batch class_batch(const ModelDescription& model, const std::vector<LabelledClip>& clips,
                  const std::vector<WindowPlace>& places, std::size_t frames);

// Log-probabilities (windows, classes) of every task, for the windows of `split`, each of `frames`
// frames. Puts the classifier into evaluation.
std::vector<Eigen::MatrixXd> class_scores(Classifier& classifier, const LabelledSplit& split,
                                          std::size_t frames, const at::Device& device);

struct PredictOptions {
  std::filesystem::path model;     // a classifier that `classify` kept
  std::vector<std::string> clips;  // as find_motions (motion/inputs.h) takes them
  MotionReading read;
  std::string precision = "auto", device = "auto";
  int threads = 0;
};

// One row a clip (of a file with several motions each) and label: the likeliest value, its
// probability (mean over the clip's windows), and the next. Throws UsageError when the model is no
// classifier, DataError for unreadable clips.
Table predict_table(const PredictOptions& options);

}  // namespace mocaplm
