// The output layer: logits over ids, and logits over the distance to the linear extrapolation of
// the same channel shifted into place (model/transformer/output.h).
#pragma once

#include <vector>

#include "generate/options.h"
#include "generate/team.h"
#include "generate/weights.h"
#include "model/config.h"

namespace mocaplm {

class OutputLayer {
 public:
  // Packs the weights of a layer on states of this width. Team and arena must outlive it.
  OutputLayer(Weights& weights, const ModelDescription& description, std::int64_t width,
              const EngineOptions& options, Team& team, Arena& arena);

  // x: normalised states (rows, width), rows <= kMaxRows; centre: of each row, the bin that
  // extrapolation predicts, or kNoCentre. One list of logits (V) a row, until the next call.
  const std::vector<std::vector<float>>& logits(const float* x,
                                                const std::vector<std::int32_t>& centre);

  const PackedLinear& head() const { return head_; }
  std::int64_t bytes() const { return head_.bytes() + offset_head_.bytes(); }

 private:
  StreamShape shape_;
  std::int64_t reach_;
  Team& team_;
  PackedLinear head_, offset_head_;
  std::vector<LinearScratch> scratch_;  // a thread's own
  std::vector<float> out_, offsets_;
  std::vector<std::vector<float>> logits_;
};

}  // namespace mocaplm
