#include "classify/baselines.h"

#include "numeric/lda.h"

namespace mocaplm {

Eigen::MatrixXd majority_scores(const LabelledSplit& train, const LabelledSplit& test,
                                std::size_t task, int classes) {
  Eigen::RowVectorXd counts = Eigen::RowVectorXd::Zero(classes);
  for (const int one : window_classes(train, task))
    if (one >= 0) counts(one) += 1;
  return counts.replicate(static_cast<Eigen::Index>(test.windows.size()), 1);
}

Eigen::MatrixXd lda_scores(const LabelledSplit& train, const LabelledSplit& test, std::size_t task,
                           int classes, const Tokenizer& tokenizer, std::size_t window_frames,
                           double shrinkage) {
  LabelledSplit labelled;  // only what has the label
  labelled.clips = train.clips;
  for (const WindowPlace& window : train.windows)
    if (train.clips[window.clip].classes[task] >= 0) labelled.windows.push_back(window);
  const Lda lda = Lda::fit(window_features(labelled, tokenizer, window_frames),
                           window_classes(labelled, task), classes, shrinkage);
  return lda.scores(window_features(test, tokenizer, window_frames));
}

}  // namespace mocaplm
