// Thesis 4.7: the last tokens of the context are one per label, they attend to the whole window
// without a causal mask, and one linear layer each maps them to the label's classes.
#pragma once

#include <memory>
#include <vector>

#include "classify/windows.h"
#include "model/transformer/language_model.h"

namespace mocaplm {

class Classifier : public torch::nn::Module {
 public:
  Classifier(std::shared_ptr<LanguageModel> transformer, const std::vector<Task>& tasks);

  struct Output {
    at::Tensor hidden;               // (B, T, C) of the motion, for the language-model loss
    std::vector<at::Tensor> logits;  // one a task: (B, classes)
  };
  Output forward(const Batch& batch);

  LanguageModel& transformer() { return *transformer_; }

 private:
  std::shared_ptr<LanguageModel> transformer_;
  at::Tensor tokens_;  // (tasks, C): the embeddings of the classification tokens
  std::vector<std::pair<at::Tensor, at::Tensor>> heads_;
};

}  // namespace mocaplm
