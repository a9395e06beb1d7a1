#include "generate/output_layer.h"

#include <algorithm>

#include "model/input.h"

namespace mocaplm {

OutputLayer::OutputLayer(Weights& weights, const ModelDescription& description, std::int64_t width,
                         const EngineOptions& options, Team& team, Arena& arena)
    : shape_(description.shape),
      reach_(description.config.reach),
      team_(team),
      head_(packed(weights, "head", shape_.vocabulary, width, options.precision, arena)),
      scratch_(static_cast<std::size_t>(team.size()), LinearScratch(width)) {
  if (description.config.output == "extrapolation")
    offset_head_ = packed(weights, "offset_head", model_sizes(description).offsets, width,
                          options.precision, arena);
  out_.resize(static_cast<std::size_t>(options.sequences * head_.out()));
  offsets_.resize(static_cast<std::size_t>(options.sequences * offset_head_.out()));
}

const std::vector<std::vector<float>>& OutputLayer::logits(
    const float* x, const std::vector<std::int32_t>& centre) {
  const auto rows = static_cast<std::int64_t>(centre.size());
  const bool shifted = offset_head_.out() > 0;
  team_.run([&](int thread) {
    LinearScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
    head_.apply(x, out_.data(), rows, Store::plain, scratch, thread, team_.size());
    if (shifted)
      offset_head_.apply(x, offsets_.data(), rows, Store::plain, scratch, thread, team_.size());
  });
  logits_.resize(centre.size());
  for (std::size_t r = 0; r < centre.size(); ++r) {
    const float* row = out_.data() + static_cast<std::int64_t>(r) * head_.out();
    logits_[r].assign(row, row + head_.out());
    if (!shifted || centre[r] == kNoCentre) continue;
    const float* offset = offsets_.data() + static_cast<std::int64_t>(r) * offset_head_.out();
    float* bins = logits_[r].data() + shape_.first_bin;
    for (std::int64_t b = 0; b < shape_.bins; ++b)
      bins[b] += offset[std::clamp<std::int64_t>(b - centre[r], -reach_, reach_) + reach_];
  }
  return logits_;
}

}  // namespace mocaplm
