#include "train/batches.h"

#include <algorithm>

namespace mocaplm {

std::uint64_t step_seed(std::int64_t seed, std::int64_t step) {
  return stable_hash("step " + std::to_string(step), static_cast<std::uint64_t>(seed));
}

Batch stack_windows(const std::vector<Window>& windows) {
  std::vector<ModelInput> inputs;
  std::vector<std::vector<std::int32_t>> targets;
  for (const Window& window : windows) {
    inputs.push_back(window.input);
    targets.push_back(window.target);
  }
  return stack(inputs, targets);
}

MicroBatches draw_batches(const WindowSampler& sampler, const TrainConfig& config,
                          std::int64_t step) {
  Random random(step_seed(config.seed, step));
  const WindowOptions options = window_options(config);
  MicroBatches made;
  for (std::int64_t done = 0; done < config.batch_size; done += config.micro_batch) {
    std::vector<Window> windows;
    for (std::int64_t i = 0; i < std::min(config.micro_batch, config.batch_size - done); ++i)
      windows.push_back(sampler.draw(random, options));
    made.batches.push_back(stack_windows(windows));
    made.targets += (made.batches.back().target >= 0).sum().item<std::int64_t>();
  }
  return made;
}

double accumulate_gradient(LanguageModel& model, const MicroBatches& batches,
                           const at::Device& device, std::uint64_t seed) {
  at::manual_seed(seed);
  model.train();
  double nats = 0;
  for (const Batch& cpu : batches.batches) {
    const Batch batch = cpu.to(device);
    const at::Tensor loss = model.loss(model.hidden(batch), batch).sum() /
                            static_cast<double>(std::max<std::int64_t>(batches.targets, 1));
    loss.backward();
    nats += loss.item<double>();
  }
  return nats;
}

}  // namespace mocaplm
