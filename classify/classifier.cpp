#include "classify/classifier.h"

namespace mocaplm {

Classifier::Classifier(std::shared_ptr<LanguageModel> transformer, const std::vector<Task>& tasks)
    : transformer_(std::move(transformer)) {
  const std::int64_t width = transformer_->description().config.n_embd;
  register_module("transformer", transformer_);
  tokens_ = register_parameter("class_embedding",
                               at::randn({static_cast<std::int64_t>(tasks.size()), width}) * 0.02);
  for (const Task& task : tasks) {
    const auto classes = static_cast<std::int64_t>(task.values.size());
    heads_.emplace_back(
        register_parameter("class_head/" + task.label + "/weight",
                           at::randn({classes, width}) * 0.02),
        register_parameter("class_head/" + task.label + "/bias", at::zeros({classes})));
  }
}

Classifier::Output Classifier::forward(const Batch& batch) {
  const std::int64_t rows = batch.token.size(0), tasks = tokens_.size(0);
  const at::Tensor states =
      transformer_->hidden(batch, tokens_.unsqueeze(0).expand({rows, tasks, tokens_.size(1)}));
  const std::int64_t length = states.size(1) - tasks;
  Output out;
  out.hidden = states.slice(1, 0, length);
  for (std::int64_t i = 0; i < tasks; ++i) {
    const auto& [weight, bias] = heads_[static_cast<std::size_t>(i)];
    out.logits.push_back(at::linear(states.select(1, length + i), weight, bias));
  }
  return out;
}

}  // namespace mocaplm
