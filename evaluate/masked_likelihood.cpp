#include "evaluate/masked_likelihood.h"

#include <algorithm>
#include <cmath>

#include "common/random.h"
#include "model/masked_input.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

struct HiddenWindow {
  std::size_t clip;
  CentralWindow window;
  int pass;
};

// The window with the tokens of one pass hidden, and as targets those of its own frames.
void add_hidden_window(const ModelDescription& model, const ScoredClip& clip,
                       const std::vector<int>& passes, const HiddenWindow& one,
                       std::vector<ModelInput>& inputs,
                       std::vector<std::vector<std::int32_t>>& targets) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const auto length = static_cast<std::size_t>(tokens_in_window(model));
  const CentralWindow& w = one.window;
  const std::size_t first = w.first * per_frame;
  std::vector<std::int32_t> shown, target(length, -1);
  for (std::size_t i = first; i < w.last * per_frame; ++i) {
    const bool hidden = passes[i] == one.pass;
    shown.push_back(hidden ? Tokenizer::kMask : clip.ids[i]);
    if (hidden && i >= w.from * per_frame && i < w.to * per_frame)
      target[clip.prefix.size() + i - first] = clip.ids[i];
  }
  ModelInput input = masked_input(model, clip.prefix, shown);
  // Padding is seen, so it is what it was in training: up to the whole window.
  while (input.size() < length) append_prefix(input, model, Tokenizer::kPad, false, shown, 0);
  inputs.push_back(std::move(input));
  targets.push_back(std::move(target));
}

}  // namespace

std::vector<int> masking_passes(const StreamShape& shape, std::size_t tokens, std::size_t clip) {
  const auto per_frame = static_cast<std::size_t>(shape.tokens_per_frame());
  std::vector<std::size_t> bins;
  for (std::size_t i = 0; i < tokens; ++i)
    if (i % per_frame + 1 < per_frame) bins.push_back(i);
  Random random(stable_hash("masking passes", clip));
  random.shuffle(bins);
  std::vector<int> passes(tokens, -1);
  for (std::size_t i = 0; i < bins.size(); ++i)
    passes[bins[i]] = static_cast<int>(i % kMaskingPasses);
  return passes;
}

std::vector<BitCount> score_masked_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                         std::int64_t windows_at_once,
                                         const WindowsDone& progress) {
  const at::NoGradGuard no_grad;
  model.eval();
  const ModelDescription& d = model.description();
  const at::Device device = model.parameters().front().device();
  const auto per_frame = static_cast<std::size_t>(d.shape.tokens_per_frame());
  std::vector<BitCount> counts(clips.size());
  std::vector<std::vector<int>> passes;
  std::vector<HiddenWindow> windows;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const std::size_t frames = clips[c].ids.size() / per_frame;
    counts[c].frames = static_cast<std::int64_t>(frames);
    counts[c].bits.assign(per_frame, 0);
    passes.push_back(masking_passes(d.shape, clips[c].ids.size(), c));
    for (const CentralWindow& window :
         central_windows(frames, static_cast<std::size_t>(frames_in_window(d))))
      for (int pass = 0; pass < kMaskingPasses; ++pass) windows.push_back({c, window, pass});
  }
  const auto at_once = static_cast<std::size_t>(windows_at_once);
  for (std::size_t i = 0; i < windows.size(); i += at_once) {
    const std::size_t end = std::min(i + at_once, windows.size());
    std::vector<ModelInput> inputs;
    std::vector<std::vector<std::int32_t>> targets;
    for (std::size_t p = i; p < end; ++p)
      add_hidden_window(d, clips[windows[p].clip], passes[windows[p].clip], windows[p], inputs,
                        targets);
    const Batch batch = stack(inputs, targets).to(device);
    const at::Tensor nats = model.loss(model.hidden(batch), batch).to(at::kCPU).contiguous();
    for (std::size_t p = i; p < end; ++p) {
      const float* row = nats.data_ptr<float>() + static_cast<std::int64_t>(p - i) * nats.size(1);
      const HiddenWindow& one = windows[p];
      const std::size_t prefix = clips[one.clip].prefix.size();
      for (std::size_t t = 0; t < (one.window.last - one.window.first) * per_frame; ++t)
        counts[one.clip].bits[t % per_frame] += row[prefix + t] / std::log(2.0);
    }
    if (progress) progress(end, windows.size());
  }
  return counts;
}

}  // namespace mocaplm
