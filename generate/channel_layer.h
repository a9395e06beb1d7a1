// The last part of a frame model (model/transformer/frame_transformer.h): from the state of a joint
// and what was chosen within it to the logits of its next channel.
#pragma once

#include <vector>

#include "generate/frame_stream_state.h"
#include "generate/kernels/linear.h"
#include "generate/options.h"
#include "generate/output_layer.h"
#include "generate/team.h"
#include "generate/weights.h"

namespace mocaplm {

class ChannelLayer {
 public:
  // Packs the weights. Team and arena must outlive it.
  ChannelLayer(Weights& weights, const ModelDescription& description, const EngineOptions& options,
               Team& team, Arena& arena);

  // features (C, kFrameFeatures) of the frame before -> stream.channels, before its frame
  // `stream.frames()`.
  void begin_frame(FrameStreamState& stream, const float* features);
  // states (rows, width) of the joints in the making -> `told` of these streams.
  void begin_joints(const std::vector<FrameStreamState*>& streams, const float* states);
  // Of the next channel of each stream, until the next call.
  const std::vector<std::vector<float>>& logits(const std::vector<FrameStreamState*>& streams);

 private:
  struct Tables {
    std::vector<float> channel, chosen, surprise, velocity, last_surprise;
  };

  void put(const FrameStreamState& stream, float* x) const;

  std::int64_t width_, bins_, channels_, history_rows_;
  Team& team_;
  PackedLinear in_, own_in_, up_, down_;
  Tables tables_;
  std::vector<float> ln1_w_, ln1_b_, ln2_w_, ln2_b_;
  OutputLayer output_;
  std::vector<LinearScratch> scratch_;  // a thread's own
  std::vector<float> x_, normed_, wide_, told_;
};

}  // namespace mocaplm
