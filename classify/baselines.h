// What the transformer is measured against, on the same windows.
#pragma once

#include <vector>

#include "classify/windows.h"

namespace mocaplm {

// (test windows, classes): the training split's class frequencies in every row.
Eigen::MatrixXd majority_scores(const LabelledSplit& train, const LabelledSplit& test,
                                std::size_t task, int classes);

// (test windows, classes): linear discriminant analysis with shrinkage on the windows' channel
// values.
Eigen::MatrixXd lda_scores(const LabelledSplit& train, const LabelledSplit& test, std::size_t task,
                           int classes, const Tokenizer& tokenizer, std::size_t window_frames,
                           double shrinkage);

}  // namespace mocaplm
