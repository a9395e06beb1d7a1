// "architecture": "frames": one position a frame for a causal transformer over time, and a small
// causal transformer over the channels of one frame, the channel decoder.
//
// The time model reads numbers that describe each whole frame (frame_features). Its state before a
// frame, the features of the frame before, and the channel's own recent movement give each channel
// an input of its own. The memory, blocks over the frames that are the same for all channels,
// relates it to that channel's past; the channel decoder goes through the channels of the frame,
// each of which sees what was chosen before it. So a window of 1,024 positions is 1,024 frames
// where the flat model has 23, and a frame costs one step of the large model and as many of the
// small one as there are channels.
#pragma once

#include "model/transformer/language_model.h"

namespace mocaplm {

// (B, F, C) bins of whole frames -> (B, F, C * kFrameFeatures), see model/input.h.
at::Tensor frame_features(const at::Tensor& bin, std::int64_t bins);

class FrameTransformer : public LanguageModel {
 public:
  explicit FrameTransformer(const ModelDescription& description);

  // A batch is a prefix and frames, the last of which may be unfinished.
  at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {}) override;
  at::Tensor logits(const at::Tensor& hidden, const Batch& batch) override;
  // In training, a share `shown_first` of the calls puts random joints (groups of three channels)
  // of each frame before the others, so that generation may put prompted ones there.
  at::Tensor loss(const at::Tensor& hidden, const Batch& batch) override;

  // The order in which frames are decoded from now on, outside training: every channel once.
  void set_order(const std::vector<std::int64_t>& channels) { order_ = channels; }

 private:
  static double as_embedding(std::int64_t inputs);
  // Columns of the batch from the position that predicts the first frame's first channel on, as
  // (B, frames, C + 1); filled up with `rest` behind the batch's end.
  at::Tensor grid(const at::Tensor& column, std::int64_t prefix, std::int64_t rest) const;
  at::Tensor whole_frames(const Batch& batch) const;  // features of them
  // Final normalised states of the channel decoder, (B * frames * C, width), the channels of a
  // frame in this order.
  at::Tensor decode(const at::Tensor& hidden, const Batch& batch, const at::Tensor& order) const;
  at::Tensor channel_past(const at::Tensor& hidden, const Batch& batch) const;
  at::Tensor column(const Batch& batch, const at::Tensor& all, const at::Tensor& at) const;
  at::Tensor draw_order() const;
  at::Tensor fixed_order(const at::Device& device) const;
  std::int64_t frames_decoded(const Batch& batch) const;

  at::Tensor token_, position_;
  std::vector<std::int64_t> order_;
  LinearWeights frame_in_, channel_in_, own_in_;
  std::vector<BlockWeights> blocks_, memory_, decoder_;
  at::Tensor ln_w_, ln_b_;
  at::Tensor channel_, time_, before_, chosen_, surprise_, velocity_, last_surprise_;
  at::Tensor decoder_ln_w_, decoder_ln_b_;
};

}  // namespace mocaplm
