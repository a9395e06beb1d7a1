#include "classify/train.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "classify/baselines.h"
#include "classify/classifier.h"
#include "classify/predict.h"
#include "common/error.h"
#include "common/files.h"
#include "common/progress.h"
#include "common/text.h"
#include "model/transformer/setup.h"
#include "model/transformer/weights.h"
#include "train/corpus.h"
#include "train/optimizer.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

using Clock = std::chrono::steady_clock;

double minutes_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count() / 60;
}

struct Setup {
  StoredModel stored;
  std::string place;
  Tokenizer tokenizer;
  Dataset dataset;
  std::vector<Task> tasks;
  std::size_t window_frames = 0;
  LabelledSplit train, validation, test;
};

// The thesis classifies windows of 1,024 tokens.
std::size_t chosen_window(const ClassifyConfig& config, const ModelDescription& model,
                          std::size_t tasks) {
  const std::int64_t room = frames_in_window(model, static_cast<std::int64_t>(tasks));
  if (config.window_frames > room)
    throw UsageError("window_frames " + std::to_string(config.window_frames) +
                     ": the model's context has room for " + std::to_string(room));
  std::int64_t frames = config.window_frames;
  if (frames == 0 && model.frame_positions()) frames = 1024 / model.shape.tokens_per_frame();
  return static_cast<std::size_t>(frames == 0 ? room : std::min(frames, room));
}

Setup set_up(const ClassifyOptions& options) {
  Setup s;
  s.place = resolve_model(options.model).string();
  s.stored = load_model(options.model);
  if (s.stored.description.masked())
    throw UsageError(s.place +
                     " is a masked model; classify takes a causal one, whose loss is "
                     "trained jointly");
  if (s.stored.description.has_pieces())
    throw UsageError(s.place +
                     " is a model of pieces; classify takes one of single characters (trained "
                     "without bpe and unigram)");
  s.tokenizer =
      Tokenizer::of_model(s.stored.tokenizer, s.stored.description.tokenizer_fingerprint, s.place);
  s.dataset = load_dataset(options.data);
  s.tasks = make_tasks(s.dataset, options.config.labels);
  // A classifier is told no conditions: they would tell it the answer.
  s.stored.description.conditions.clear();
  s.window_frames = chosen_window(options.config, s.stored.description, s.tasks.size());
  const auto split = [&](const char* name, bool mirror) {
    return label_split(s.dataset, name, s.tokenizer, s.tasks, s.window_frames, mirror,
                       options.threads);
  };
  s.train = split("train", options.config.mirror);
  s.validation = split("validation", false);
  s.test = split(options.split.c_str(), false);
  return s;
}

class Training {
 public:
  Training(Setup& setup, const ClassifyOptions& options)
      : s_(setup),
        config_(options.config),
        device_(choose_device(options.device)),
        random_(static_cast<std::uint64_t>(config_.seed)) {
    at::manual_seed(static_cast<std::uint64_t>(config_.seed));
    s_.stored.description.config.dropout = config_.dropout;
    auto transformer = load_transformer(s_.stored, s_.place);
    transformer->set_precision(choose_precision(config_.precision, device_));
    classifier_ = std::make_shared<Classifier>(transformer, s_.tasks);
    classifier_->to(device_);
    schedule_.learning_rate = config_.learning_rate > 0 ? config_.learning_rate : default_rate();
    schedule_.warmup = std::min<std::int64_t>(30, config_.steps / 4);
    schedule_.weight_decay = 0.05;
    optimizer_ = std::make_unique<Optimizer>(*classifier_, schedule_);
  }

  // Keeps the weights that do best on the validation split.
  Classifier& run() {
    Progress bar("classify", static_cast<std::size_t>(config_.steps), "steps", 30);
    const auto start = Clock::now();
    TensorMap best;
    double best_accuracy = -1, looking = 0;
    char note[160] = "";
    for (std::int64_t step = 0; step < config_.steps; ++step) {
      double progress = static_cast<double>(step) / static_cast<double>(config_.steps);
      if (config_.max_minutes > 0)
        progress = std::max(progress, minutes_since(start) / config_.max_minutes);
      const auto [language, classes] = one_step(step, progress);
      const bool last = step + 1 == config_.steps || progress >= 1;
      // A run by the clock spends at most a tenth of it on looking.
      const bool affordable = config_.max_minutes <= 0 || looking < 0.1 * minutes_since(start);
      if (((step + 1) % config_.validate_every == 0 && affordable) || last) {
        const auto looked = Clock::now();
        const double accuracy = validation_accuracy();
        looking += minutes_since(looked);
        if (accuracy > best_accuracy) {
          best_accuracy = accuracy;
          best = export_weights(*classifier_);
        }
        std::snprintf(note, sizeof note,
                      "language loss %.3f, class loss %.3f, validation accuracy %.1f %%", language,
                      classes, 100 * accuracy);
        bar.print("step " + std::to_string(step + 1) + ": " + note);
      }
      bar.update(static_cast<std::size_t>(step + 1), note, config_.max_minutes > 0 ? progress : -1);
      if (last) break;
    }
    bar.finish(note);
    import_weights(*classifier_, best, "classifier");
    return *classifier_;
  }

  const at::Device& device() const { return device_; }

 private:
  double default_rate() const {
    const Json& training = s_.stored.description.training;
    const Json::json_pointer at("/config/train/learning_rate");
    const double rate = training.is_object() && training.contains(at) && training[at].is_number()
                            ? training[at].get<double>()
                            : 0;
    return std::max(rate, 2e-5);
  }

  std::size_t short_frames() const {
    const std::size_t wanted = config_.short_frames > 0
                                   ? static_cast<std::size_t>(config_.short_frames)
                                   : s_.window_frames / 5;
    return std::clamp<std::size_t>(wanted, 1, s_.window_frames);
  }

  std::pair<double, double> one_step(std::int64_t step, double progress) {
    at::manual_seed(
        stable_hash("classify " + std::to_string(step), static_cast<std::uint64_t>(config_.seed)));
    const std::size_t frames = progress < config_.short_windows ? short_frames() : s_.window_frames;
    const std::vector<WindowPlace> places = draw(frames);
    const Batch batch =
        class_batch(s_.stored.description, s_.train.clips, places, frames).to(device_);
    classifier_->train();
    optimizer_->zero_grad();
    const Classifier::Output out = classifier_->forward(batch);
    const at::Tensor counted = (batch.target >= 0).sum();
    const at::Tensor language = classifier_->transformer().loss(out.hidden, batch).sum() / counted;
    at::Tensor classes = at::zeros({}, language.options());
    for (std::size_t k = 0; k < s_.tasks.size(); ++k)
      classes = classes + class_loss(out.logits[k], places, k);
    (config_.language_loss * language + classes).backward();
    const double norm = optimizer_->step(scheduled_rate(schedule_, step, progress));
    const double nats = language.item<double>(), class_nats = classes.item<double>();
    if (!std::isfinite(nats) || !std::isfinite(class_nats) || !std::isfinite(norm))
      throw DataError(
          in_file(s_.place),
          "training the classifier stopped at step " + std::to_string(step + 1) +
              ": the loss is not finite; try a lower --learning-rate or --precision f32");
    return {nats, class_nats};
  }

  // A clip is as likely as it is long, its window starts anywhere.
  std::vector<WindowPlace> draw(std::size_t frames) {
    std::vector<WindowPlace> places;
    const auto per_frame = static_cast<std::size_t>(s_.tokenizer.tokens_per_frame());
    for (std::int64_t i = 0; i < config_.batch_size; ++i) {
      const std::size_t clip = s_.train.windows[random_.below(s_.train.windows.size())].clip;
      const std::size_t starts = s_.train.clips[clip].ids.size() / per_frame - frames + 1;
      places.push_back({clip, random_.below(starts)});
    }
    return places;
  }

  at::Tensor class_loss(const at::Tensor& logits, const std::vector<WindowPlace>& places,
                        std::size_t task) const {
    at::Tensor truth = at::empty({static_cast<std::int64_t>(places.size())}, at::kLong);
    for (std::size_t i = 0; i < places.size(); ++i)
      truth.data_ptr<std::int64_t>()[i] = s_.train.clips[places[i].clip].classes[task];
    truth = truth.to(device_);
    const at::Tensor known = (truth >= 0).to(logits.scalar_type());
    const at::Tensor nats =
        -at::log_softmax(logits, -1).gather(1, truth.clamp_min(0).unsqueeze(1)).squeeze(1);
    return (nats * known).sum() / known.sum().clamp_min(1);
  }

  // Mean over the tasks of the accuracy on (at most 256 of) the validation windows.
  double validation_accuracy() {
    LabelledSplit some;
    some.clips = s_.validation.clips;
    const std::size_t all = s_.validation.windows.size(), wanted = std::min<std::size_t>(all, 256);
    for (std::size_t i = 0; i < wanted; ++i)
      some.windows.push_back(s_.validation.windows[i * all / wanted]);
    const std::vector<Eigen::MatrixXd> scores =
        class_scores(*classifier_, some, s_.window_frames, device_);
    double sum = 0;
    for (std::size_t k = 0; k < s_.tasks.size(); ++k)
      sum += score_task(some, k, scores[k]).window_accuracy;
    return sum / static_cast<double>(s_.tasks.size());
  }

  Setup& s_;
  ClassifyConfig config_;
  at::Device device_;
  Random random_;
  std::shared_ptr<Classifier> classifier_;
  TrainConfig schedule_;
  std::unique_ptr<Optimizer> optimizer_;
};

MethodScores baseline(const std::string& name, const Setup& s, const ClassifyOptions& options,
                      bool lda) {
  MethodScores scores{name, {}};
  for (std::size_t k = 0; k < s.tasks.size(); ++k) {
    const int classes = static_cast<int>(s.tasks[k].values.size());
    scores.tasks.push_back(score_task(s.test, k,
                                      lda ? lda_scores(s.train, s.test, k, classes, s.tokenizer,
                                                       s.window_frames, options.config.shrinkage)
                                          : majority_scores(s.train, s.test, k, classes)));
  }
  return scores;
}

void save(const ClassifyOptions& options, const Setup& s, Classifier& classifier,
          const ClassifyResult& result) {
  StoredModel stored = s.stored;
  for (const Task& task : s.tasks) stored.description.classes.emplace_back(task.label, task.values);
  stored.description.class_frames = static_cast<std::int64_t>(s.window_frames);
  stored.tensors = export_weights(classifier);
  classifier.transformer().to(at::kCPU);
  std::vector<ModelInput> inputs;
  for (const SelfTestCase& one : s.stored.self_test) inputs.push_back(one.input);
  stored.self_test = make_self_test(classifier.transformer(), inputs);
  Json tables = Json::array();
  for (const Table& table : classify_tables(result)) tables.push_back(table.json());
  save_model(options.out, stored, [&](const fs::path& directory) {
    save_json(directory / "classification.json", {{"settings", settings_json(options.config)},
                                                  {"data", fs::absolute(options.data).string()},
                                                  {"tables", tables}});
  });
}

// Only an earlier classifier is replaced: a language model may have taken days.
void check_out(const fs::path& out) {
  if (out.empty() || !fs::exists(out) || (fs::is_directory(out) && fs::is_empty(out))) return;
  if (!looks_like_model(out))
    throw UsageError(out.string() + " exists and is no classifier's folder: give another --out");
  if (!fs::exists(out / "config.json") || load_description(out).classes.empty())
    throw UsageError(out.string() + " holds a model that is no classifier: give another --out");
}

}  // namespace

ClassifyResult classify(const ClassifyOptions& options) {
  check_out(options.out);
  set_up_cpu(options.threads);
  Setup s = set_up(options);
  const auto start = Clock::now();
  ClassifyResult result;
  result.tasks = s.tasks;
  result.window_frames = s.window_frames;
  result.fps = s.tokenizer.config().fps;
  result.procedural = s.dataset.procedural;
  result.methods.push_back(baseline("Majority class", s, options, false));
  result.methods.push_back(baseline("LDA", s, options, true));
  Training training(s, options);
  Classifier& classifier = training.run();
  const std::vector<Eigen::MatrixXd> scores =
      class_scores(classifier, s.test, s.window_frames, training.device());
  MethodScores own{"Transformer", {}};
  for (std::size_t k = 0; k < s.tasks.size(); ++k)
    own.tasks.push_back(score_task(s.test, k, scores[k]));
  result.methods.push_back(own);
  result.seconds = 60 * minutes_since(start);
  if (!options.out.empty()) save(options, s, classifier, result);
  return result;
}

std::vector<Table> classify_tables(const ClassifyResult& result) {
  std::vector<Table> tables;
  const TaskScore& first = result.methods.front().tasks.front();
  const std::string what = std::to_string(result.window_frames) + " frames at " +
                           format_number(result.fps) + " per second";
  tables.push_back(accuracy_table("Accuracy of windows (" + what + "), %", result.tasks,
                                  result.methods, &TaskScore::window_accuracy));
  tables.back().note(std::to_string(first.windows) + " windows of " + std::to_string(first.clips) +
                     " clips" + (result.procedural ? ", procedural dances" : ""));
  tables.push_back(accuracy_table("Accuracy of clips, %", result.tasks, result.methods,
                                  &TaskScore::clip_accuracy));
  tables.push_back(accuracy_table("Balanced accuracy of windows, %", result.tasks, result.methods,
                                  &TaskScore::balanced_window_accuracy));
  tables.push_back(accuracy_table("Balanced accuracy of clips, %", result.tasks, result.methods,
                                  &TaskScore::balanced_clip_accuracy));
  for (std::size_t k = 0; k < result.tasks.size(); ++k)
    tables.push_back(confusion_table(result.tasks[k], result.methods.back(), k));
  return tables;
}

}  // namespace mocaplm
