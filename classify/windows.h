// The windows that all classifiers see: as many whole frames as the model's context holds.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/random.h"
#include "model/input.h"
#include "motion/dataset.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

struct Task {
  std::string label;
  std::vector<std::string> values;  // class names
};

struct LabelledClip {
  std::string name;
  std::vector<std::int32_t>
      ids;  // at least one window of whole frames: shorter clips hold their last pose
  std::vector<int> classes;  // one a task, -1 where the clip lacks the label or its value is new
};

struct WindowPlace {
  std::size_t clip, first_frame;
};

struct LabelledSplit {
  std::vector<LabelledClip> clips;
  std::vector<WindowPlace> windows;  // every half window, each clip's last frames included
};

// Tasks for the labels asked for (all with at least two values in the training split when none
// are). Throws UsageError with the nearest label for unknown ones.
std::vector<Task> make_tasks(const Dataset& dataset, const std::vector<std::string>& labels);

// One clip as it is classified.
LabelledClip label_clip(const Clip& clip, const Tokenizer& tokenizer,
                        const std::vector<Task>& tasks, std::size_t window_frames);
// Appends the windows of one clip of the split.
void add_windows(LabelledSplit& split, std::size_t clip, const Tokenizer& tokenizer,
                 std::size_t window_frames);

LabelledSplit label_split(const Dataset& dataset, const std::string& split,
                          const Tokenizer& tokenizer, const std::vector<Task>& tasks,
                          std::size_t window_frames, bool mirror, int threads);

// (windows, frames * channels) channel values in radians and metres: what LDA sees.
Eigen::MatrixXd window_features(const LabelledSplit& split, const Tokenizer& tokenizer,
                                std::size_t window_frames);
// One class a window.
std::vector<int> window_classes(const LabelledSplit& split, std::size_t task);

}  // namespace mocaplm
