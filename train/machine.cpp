#include "train/machine.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <torch/cuda.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "model/transformer/setup.h"
#include "train/batches.h"
#include "train/optimizer.h"

namespace mocaplm {

namespace {

constexpr double kTokensAParameter = 20;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Waits for a device that computes beside the program.
void finish(const at::Device& device) {
  if (device.is_cuda()) torch::cuda::synchronize();
}

// FLOP/s of the best of some products (2048, 1024) (1024, 1024) in f32. (In bf16 LibTorch's own may
// be plain loops on a processor: training there has kernels of ours.)
double product_rate(const at::Device& device, double seconds) {
  const at::NoGradGuard no_grad;
  const at::Tensor x = at::randn({2048, 1024}).to(device);
  const at::Tensor w = at::randn({1024, 1024}).to(device);
  double best = 0;
  const double begin = now();
  for (int i = 0; i < 3 || now() - begin < seconds; ++i) {
    const double start = now();
    at::linear(x, w);
    finish(device);
    if (i > 0) best = std::max(best, 2.0 * 2048 * 1024 * 1024 / (now() - start));
  }
  return best;
}

// The stream that the default tokenizer gives: 13 joints and the root's steps in 360 bins.
ModelDescription default_model() {
  ModelDescription description;
  description.shape = {364, 4, 360, 42};
  description.config.dropout = 0;
  return description;
}

// Each channel wanders over the bins.
Corpus made_up_corpus(const StreamShape& shape, std::int64_t frames) {
  Random random(1);
  EncodedClip clip;
  std::vector<std::int64_t> bins(static_cast<std::size_t>(shape.channels), shape.bins / 2);
  for (std::int64_t t = 0; t < frames; ++t) {
    for (std::int64_t& bin : bins) {
      bin = std::clamp<std::int64_t>(bin + static_cast<std::int64_t>(random.below(5)) - 2, 0,
                                     shape.bins - 1);
      clip.ids.push_back(static_cast<std::int32_t>(shape.first_bin + bin));
    }
    clip.ids.push_back(3);
  }
  Corpus corpus;
  corpus.clips.push_back(clip);
  corpus.frames = frames;
  return corpus;
}

TrainingSpeed step_rate(const at::Device& device, at::ScalarType precision, double seconds) {
  at::manual_seed(1);
  const ModelDescription description = default_model();
  const Corpus corpus = made_up_corpus(description.shape, 400);
  const WindowSampler sampler(corpus, description);
  TrainConfig config;
  config.batch_size = config.micro_batch = 8;
  const std::shared_ptr<LanguageModel> model = make_language_model(description);
  model->to(device);
  model->set_precision(precision);
  Optimizer optimizer(*model, config);
  const MicroBatches batches = draw_batches(sampler, config, 0);
  std::vector<double> times;
  const double begin = now();
  for (int i = 0; i < 3 || now() - begin < seconds; ++i) {
    const double start = now();
    optimizer.zero_grad();
    accumulate_gradient(*model, batches, device, 1);
    optimizer.step(1e-4);
    finish(device);
    if (i > 0) times.push_back(now() - start);  // the first step makes room
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                   times.end());
  TrainingSpeed speed;
  speed.parameters = parameter_count(description);
  speed.seconds_a_step = times[times.size() / 2];
  speed.tokens_per_second =
      static_cast<double>(config.batch_size * tokens_in_window(description)) / speed.seconds_a_step;
  return speed;
}

}  // namespace

TrainingLibrary training_library(int threads) {
  set_up_cpu(threads);
  TrainingLibrary library;
  library.version = TORCH_VERSION;
  library.cuda = at::hasCUDA();
  library.cuda_devices = library.cuda ? static_cast<int>(torch::cuda::device_count()) : 0;
  library.threads = at::get_num_threads();
  library.kernels = choose_precision("auto", at::kCPU) == at::kBFloat16;
  return library;
}

MachineSpeed measure_training(const std::string& device_name, int threads, double seconds) {
  set_up_cpu(threads);
  const at::Device device = choose_device(device_name);
  const at::ScalarType precision = choose_precision("auto", device);
  MachineSpeed speed;
  speed.device = device.is_cuda() ? "cuda" : "cpu";
  speed.precision = precision == at::kBFloat16 ? "bf16" : "f32";
  speed.products = product_rate(device, 0.15 * seconds);
  speed.training = step_rate(device, precision, 0.85 * seconds);
  return speed;
}

double parameters_for(double flops, double seconds) {
  return std::sqrt(flops * seconds / (6 * kTokensAParameter));
}

}  // namespace mocaplm
