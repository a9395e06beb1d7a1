#include "classify/predict.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "model/transformer/setup.h"
#include "model/transformer/weights.h"
#include "motion/inputs.h"
#include "train/corpus.h"

namespace mocaplm {

namespace {

struct StoredClassifier {
  Tokenizer tokenizer;
  std::vector<Task> tasks;
  std::shared_ptr<Classifier> classifier;
  std::size_t window_frames = 0;
};

StoredClassifier load_classifier(const PredictOptions& options, const at::Device& device) {
  const std::string place = resolve_model(options.model).string();
  StoredModel stored = load_model(options.model);
  StoredClassifier out;
  for (const auto& [label, values] : stored.description.classes)
    out.tasks.push_back({label, values});
  if (out.tasks.empty() || stored.description.class_frames == 0)
    throw UsageError(place + " is no classifier: train one with `mocaplm classify --model " +
                     place + " --data DATASET --out FOLDER`");
  out.tokenizer =
      Tokenizer::of_model(stored.tokenizer, stored.description.tokenizer_fingerprint, place);
  stored.description.conditions.clear();
  out.window_frames = static_cast<std::size_t>(stored.description.class_frames);
  const TensorMap tensors = stored.tensors;
  auto transformer = load_transformer(stored, place);
  transformer->set_precision(choose_precision(options.precision, device));
  out.classifier = std::make_shared<Classifier>(transformer, out.tasks);
  import_weights(*out.classifier, tensors, place + "/model.safetensors");
  out.classifier->to(device);
  return out;
}

// Mean probability of each class over the windows, likeliest first.
std::vector<std::pair<double, std::size_t>> ranked(const Eigen::MatrixXd& log_scores) {
  const Eigen::RowVectorXd mean = log_scores.array().exp().matrix().colwise().mean();
  std::vector<std::pair<double, std::size_t>> order;
  for (Eigen::Index c = 0; c < mean.size(); ++c)
    order.emplace_back(mean(c), static_cast<std::size_t>(c));
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  return order;
}

// What it says of a clip, a row for each label.
void add_rows(StoredClassifier& stored, const NamedMotion& motion, const at::Device& device,
              Table& table) {
  LabelledSplit split;
  split.clips.push_back(
      label_clip(motion.read.clip, stored.tokenizer, stored.tasks, stored.window_frames));
  add_windows(split, 0, stored.tokenizer, stored.window_frames);
  const auto scores = class_scores(*stored.classifier, split, stored.window_frames, device);
  for (std::size_t k = 0; k < stored.tasks.size(); ++k) {
    const auto order = ranked(scores[k]);
    const auto value = [&](std::size_t i) { return stored.tasks[k].values[order[i].second]; };
    const bool two = order.size() > 1;
    table.row({motion.text, stored.tasks[k].label, value(0), 100 * order[0].first,
               two ? Json(value(1)) : Json(nullptr),
               two ? Json(100 * order[1].first) : Json(nullptr), split.windows.size()});
  }
}

}  // namespace

Batch class_batch(const ModelDescription& model, const std::vector<LabelledClip>& clips,
                  const std::vector<WindowPlace>& places, std::size_t frames) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const std::size_t count = frames * per_frame;
  std::vector<ModelInput> inputs;
  std::vector<std::vector<std::int32_t>> targets;
  for (const WindowPlace& place : places) {
    const std::vector<std::int32_t>& ids = clips[place.clip].ids;
    const std::size_t first = place.first_frame * per_frame;
    inputs.push_back(window_input(model, {Tokenizer::kStart}, ids, first, count));
    const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(first);
    targets.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
    targets.back().push_back(-1);
  }
  return stack(inputs, targets);
}

std::vector<Eigen::MatrixXd> class_scores(Classifier& classifier, const LabelledSplit& split,
                                          std::size_t frames, const at::Device& device) {
  const at::NoGradGuard no_grad;
  classifier.eval();
  const ModelDescription& model = classifier.transformer().description();
  const std::vector<WindowPlace>& windows = split.windows;
  std::vector<Eigen::MatrixXd> scores;
  constexpr std::size_t kAtOnce = 16;
  for (std::size_t i = 0; i < windows.size(); i += kAtOnce) {
    const std::size_t end = std::min(i + kAtOnce, windows.size());
    const std::vector<WindowPlace> some(windows.begin() + static_cast<std::ptrdiff_t>(i),
                                        windows.begin() + static_cast<std::ptrdiff_t>(end));
    const Classifier::Output out =
        classifier.forward(class_batch(model, split.clips, some, frames).to(device));
    for (std::size_t k = 0; k < out.logits.size(); ++k) {
      const at::Tensor logs =
          at::log_softmax(out.logits[k], -1).to(at::kCPU, at::kDouble).contiguous();
      if (i == 0)
        scores.emplace_back(static_cast<Eigen::Index>(windows.size()),
                            static_cast<Eigen::Index>(logs.size(1)));
      using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      scores[k].middleRows(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(end - i)) =
          Eigen::Map<const Rows>(logs.data_ptr<double>(), static_cast<Eigen::Index>(end - i),
                                 scores[k].cols());
    }
  }
  return scores;
}

Table predict_table(const PredictOptions& options) {
  set_up_cpu(options.threads);
  const at::Device device = choose_device(options.device);
  StoredClassifier stored = load_classifier(options, device);
  Table table("Predicted", {"clip", "label", "value", "%", "next", "% of next", "windows"});
  table.digits({-1, -1, -1, 1, -1, 1, -1});
  for (const MotionInput& input : find_motions(options.clips, {}, options.read))
    for (const NamedMotion& motion : read_motions(input, options.read))
      add_rows(stored, motion, device, table);
  return table;
}

}  // namespace mocaplm
