#include "train/trainer.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <future>
#include <limits>

#include "common/error.h"
#include "common/files.h"
#include "common/progress.h"
#include "common/text.h"
#include "model/transformer/setup.h"
#include "train/batches.h"
#include "train/epochs.h"
#include "train/setup.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Enough to go through every part of a model; not whole frames, as a rule.
constexpr std::size_t kSelfTestTokens = 1024;

ModelInput self_test_window(const ModelDescription& model, const Window& window) {
  const auto prefix = static_cast<std::size_t>(model.prefix()),
             per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  if (model.has_pieces()) return slice(window.input, 0, std::min(kSelfTestTokens, window.size));
  std::size_t tokens = std::min(kSelfTestTokens, prefix + window.frames * per_frame);
  if ((tokens - prefix) % per_frame + 1 == per_frame) --tokens;  // a bin comes next
  return slice(window.input, 0, tokens);
}

// What is kept beside the weights so that a run goes on as if it had not stopped.
struct Progressed {
  std::int64_t step = 0;
  double best_nats = std::numeric_limits<double>::infinity();
  double seconds = 0;
};

class Run {
 public:
  Run(const TrainOptions& options, TrainSetup setup)
      : options_(options),
        setup_(std::move(setup)),
        config_(setup_.config.train),
        device_(choose_device(options.device)),
        epochs_(setup_.train, setup_.description,
                steps_of_an_epoch(setup_.train.frames, config_.batch_size,
                                  window_frames(setup_.description)),
                epoch_encoder()),
        validation_(
            even_windows(setup_.validation, setup_.description, config_.validation_windows)),
        per_frame_(predicted_per_frame(setup_.validation, setup_.description)),
        optimizer_((setup_.model->to(device_), *setup_.model), config_) {
    setup_.model->set_precision(choose_precision(config_.precision, device_));
    setup_.description.training = {
        {"config", to_json(setup_.config)},
        {"data", fs::absolute(options.data).string()},
        {"from", options.from ? Json(fs::absolute(*options.from).string()) : Json(nullptr)}};
    if (options.resume) restore();
  }

  TrainResult go() {
    start_ = Clock::now();
    Progress bar(options_.from ? "fine-tune" : "train", static_cast<std::size_t>(config_.steps),
                 "steps", 30);
    bar.start_from(static_cast<std::size_t>(done_.step));
    std::future<MicroBatches> next = ahead(done_.step);
    const std::int64_t first_step = done_.step;
    std::int64_t tokens = 0;
    bool stopped = false;
    while (done_.step < config_.steps && progress() < 1 && !stopped) {
      const auto waited_from = Clock::now();
      const MicroBatches batches = next.get();
      waiting_ += seconds_since(waited_from);
      next = ahead(done_.step + 1);
      const double nats = one_step(batches);
      tokens += config_.batch_size * tokens_in_window(setup_.description);
      ++done_.step;
      smooth_ = smooth_ == 0 ? nats : 0.95 * smooth_ + 0.05 * nats;
      rate_ = static_cast<double>(tokens) / seconds_since(start_);
      const bool last = done_.step == config_.steps || progress() >= 1;
      if (done_.step % config_.validate_every == 0 || last) validate(bar, last);
      stopped = done_.step == options_.stop_after_step;
      if (done_.step % config_.save_every == 0 || last || stopped)
        save(options_.out / "last", true);
      bar.update(static_cast<std::size_t>(done_.step), note(),
                 config_.max_minutes > 0 ? progress() : -1);
    }
    next.wait();
    bar.finish(note());
    TrainResult result;
    result.model = resolve_model(options_.out);
    result.steps = done_.step - first_step;
    result.best_bits_per_frame = bits(done_.best_nats);
    result.tokens_per_second = rate_;
    result.seconds = elapsed();
    result.seconds_waiting = waiting_;
    for (const at::Tensor& parameter : setup_.model->parameters())
      result.parameters += parameter.numel();
    return result;
  }

 private:
  double bits(double nats) const { return bits_per_frame(nats, per_frame_); }
  double elapsed() const { return done_.seconds + seconds_since(start_); }

  // Share of the run that is done, by steps or by time, whichever is further.
  double progress() const {
    const double by_step = static_cast<double>(done_.step) / static_cast<double>(config_.steps);
    return config_.max_minutes > 0 ? std::max(by_step, elapsed() / (60 * config_.max_minutes))
                                   : by_step;
  }

  std::string note() const {
    char text[200];
    std::snprintf(text, sizeof text, "loss %.4f, %.1f bits/frame, %.0f tokens/s", smooth_,
                  bits(smooth_), rate_);
    return std::isfinite(done_.best_nats)
               ? std::string(text) + ", validation best " + format_fixed(bits(done_.best_nats), 1)
               : text;
  }

  // Null where every epoch has the clips as they are.
  Epochs::Encode epoch_encoder() const {
    Augmentation augmentation{config_.heading, config_.speed, 0};
    if (!augmentation.any()) return nullptr;
    return [this, augmentation](std::int64_t epoch, const std::atomic<bool>& stop) mutable {
      augmentation.seed =
          stable_hash("epoch " + std::to_string(epoch), static_cast<std::uint64_t>(config_.seed));
      // One thread: the others train.
      Corpus corpus = encode_split(setup_.dataset, "train", setup_.encoding(), config_.mirror, 1,
                                   augmentation, &stop);
      balance_corpus(setup_, corpus);
      return corpus;
    };
  }

  std::future<MicroBatches> ahead(std::int64_t step) {
    return std::async(std::launch::async,
                      [this, step] { return draw_batches(epochs_.at(step), config_, step); });
  }

  double one_step(const MicroBatches& batches) {
    optimizer_.zero_grad();
    const double nats =
        accumulate_gradient(*setup_.model, batches, device_, step_seed(config_.seed, done_.step));
    const double norm = optimizer_.step(scheduled_rate(config_, done_.step, progress()));
    if (!std::isfinite(nats)) diverged("the loss");
    if (!std::isfinite(norm)) diverged("the gradient");
    return nats;
  }

  [[noreturn]] void diverged(const std::string& what) const {
    throw DataError(in_file(options_.out.string()),
                    "training stopped after step " + std::to_string(done_.step) + ": " + what +
                        " is not finite. What was saved is intact; try a lower --learning-rate or "
                        "--precision f32 with another --out");
  }

  void validate(Progress& bar, bool last) {
    const at::NoGradGuard no_grad;
    setup_.model->eval();
    double sum = 0;
    std::int64_t count = 0;
    const auto micro = static_cast<std::size_t>(config_.micro_batch);
    for (std::size_t i = 0; i < validation_.size(); i += micro) {
      const std::vector<Window> some(validation_.begin() + static_cast<std::ptrdiff_t>(i),
                                     validation_.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                               i + micro, validation_.size())));
      const Batch batch = stack_windows(some).to(device_);
      sum += setup_.model->loss(setup_.model->hidden(batch), batch).sum().item<double>();
      count += (batch.target >= 0).sum().item<std::int64_t>();
    }
    const double nats = sum / static_cast<double>(std::max<std::int64_t>(count, 1));
    if (!std::isfinite(nats)) diverged("the validation loss");
    if (nats < done_.best_nats) {
      done_.best_nats = nats;
      save(options_.out / "best", false);
    }
    report(nats);
    char text[160];
    std::snprintf(text, sizeof text, "step %lld: validation loss %.4f, %.2f bits/frame",
                  static_cast<long long>(done_.step), nats, bits(nats));
    bar.print(text);
    if (options_.on_validation)
      options_.on_validation(
          {done_.step, bits(nats), last, setup_.dataset, [this] { return stored_model(); }});
  }

  void report(double validation_nats) {
    const Json line = {{"step", done_.step},
                       {"loss", smooth_},
                       {"bits_per_frame", bits(smooth_)},
                       {"validation_loss", validation_nats},
                       {"validation_bits_per_frame", bits(validation_nats)},
                       {"learning_rate", scheduled_rate(config_, done_.step, progress())},
                       {"tokens_per_second", rate_},
                       {"seconds", elapsed()},
                       {"seconds_waiting_for_data", waiting_}};
    std::ofstream(options_.out / "log.jsonl", std::ios::app) << line.dump() << "\n";
  }

  StoredModel stored_model() const {
    StoredModel stored;
    stored.description = setup_.description;
    stored.tensors = export_weights(*setup_.model);
    stored.tokenizer = setup_.tokenizer.to_json();
    stored.pieces = setup_.piece_bytes;
    return stored;
  }

  void save(const fs::path& path, bool resumable) {
    StoredModel stored = stored_model();
    std::vector<ModelInput> inputs;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, validation_.size()); ++i)
      inputs.push_back(self_test_window(setup_.description, validation_[i]));
    stored.self_test = make_self_test(*setup_.model, inputs);
    for (const SelfTestCase& one : stored.self_test)
      for (const float logit : one.logits)
        if (!std::isfinite(logit)) diverged("a logit");
    save_model(path, stored, [&](const fs::path& directory) {
      if (!resumable) return;
      optimizer_.save(directory / "optimizer.safetensors");
      save_json(
          directory / "state.json",
          {{"step", done_.step},
           {"best_nats", std::isfinite(done_.best_nats) ? Json(done_.best_nats) : Json(nullptr)},
           {"seconds", elapsed()},
           {"smooth", smooth_}});
    });
  }

  void restore() {
    const fs::path last = options_.out / "last";
    JsonObject state(load_json(last / "state.json"), (last / "state.json").string());
    done_.step = state.integer("step", 0);
    if (!state.raw("best_nats").is_null()) done_.best_nats = state.number("best_nats");
    done_.seconds = state.number("seconds", 0);
    smooth_ = state.number("smooth");
    state.finish();
    optimizer_.load(last / "optimizer.safetensors");
  }

  TrainOptions options_;
  TrainSetup setup_;
  TrainConfig config_;
  at::Device device_;
  Epochs epochs_;
  std::vector<Window> validation_;
  double per_frame_;  // predicted tokens of a frame
  Optimizer optimizer_;
  Progressed done_;
  double smooth_ = 0, rate_ = 0, waiting_ = 0;
  Clock::time_point start_ = Clock::now();
};

void check_out(const TrainOptions& options) {
  const fs::path& out = options.out;
  if (fs::exists(out) && !fs::is_directory(out))
    throw DataError(in_file(out.string()), "is a file, expected a folder for the run");
  const bool has_run = fs::exists(out / "settings.json") || fs::exists(out / "last");
  if (options.resume && !fs::exists(out / "last"))
    throw UsageError("--resume: " + out.string() +
                     " holds no checkpoint (no folder last/): start again with another --out");
  if (!options.resume && has_run)
    throw UsageError(
        out.string() +
        " already holds a training run: use --resume to go on with it, or another --out");
  if (!options.resume && fs::exists(out) && !fs::is_empty(out))
    throw UsageError(out.string() + " is not empty and holds no training run: give another --out");
}

}  // namespace

double bits_per_frame(double nats_per_token, const ModelDescription& model) {
  return bits_per_frame(nats_per_token, static_cast<double>(model.predicted_per_frame()));
}

double bits_per_frame(double nats_per_token, double predicted_per_frame) {
  return nats_per_token * predicted_per_frame / std::log(2.0);
}

TrainResult train(const TrainOptions& given) {
  TrainOptions options = given;
  check_out(options);
  const fs::path settings = options.out / "settings.json";
  if (options.resume) {
    JsonObject stored(load_json(settings), settings.string());
    const Json config = stored.raw("config");
    options.config = run_config_from_json(config, settings.string());
    if (!stored.raw("from").is_null()) options.from = stored.text("from");
    if (options.data.empty()) options.data = stored.text("data");
  }
  set_up_cpu(options.threads);
  TrainSetup setup = set_up_training(options);
  if (!options.resume) {
    fs::create_directories(options.out);
    save_json(settings, {{"config", to_json(setup.config)},
                         {"data", fs::absolute(options.data).string()},
                         {"from", options.from ? Json(fs::absolute(*options.from).string())
                                               : Json(nullptr)}});
  }
  return Run(options, std::move(setup)).go();
}

}  // namespace mocaplm
