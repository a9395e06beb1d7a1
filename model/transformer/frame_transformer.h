// "architecture": "frames": one position a frame for a causal transformer over time, and a small
// causal transformer over the joints of one frame, the joint decoder. A joint is three channels: a
// rotation's components, or the root's translation.
//
// The time model reads numbers that describe each whole frame (frame_features). Its state before a
// frame, the features of the frame before, and the joint's own recent movement give each joint an
// input of its own. The memory, blocks over the frames that are the same for all joints, relates it
// to that joint's past; the joint decoder goes through the joints of the frame, each of which sees
// what was chosen before it. From its state, a layer told what was chosen within the joint decides
// the three channels one after the other. So a window of 1,024 positions is 1,024 frames where the
// flat model has 23, and a frame costs one step of the large model, a step of the small one for
// each joint, and one layer for each channel.
#pragma once

#include "model/transformer/embedding_sum.h"
#include "model/transformer/language_model.h"

namespace mocaplm {

class FrameTransformer : public LanguageModel {
 public:
  explicit FrameTransformer(const ModelDescription& description);

  // A batch is a prefix and frames, the last of which may be unfinished.
  at::Tensor hidden(const Batch& batch, const at::Tensor& extra = {}) override;
  at::Tensor logits(const at::Tensor& hidden, const Batch& batch) override;
  // In training, a share `shown_first` of the calls puts random joints of each frame before the
  // others, so that generation may put prompted ones there.
  at::Tensor loss(const at::Tensor& hidden, const Batch& batch) override;

  // The order in which frames are decoded from now on, outside training: every joint once.
  void set_order(const std::vector<std::int64_t>& joints) { order_ = joints; }

 private:
  static double as_embedding(std::int64_t inputs);
  void make_decoder();
  std::int64_t joints() const { return description_.shape.channels / kJointChannels; }
  // Columns of the batch from the position that predicts the first frame's first channel on, as
  // (B, frames, C + 1); filled up with `rest` behind the batch's end.
  at::Tensor grid(const at::Tensor& column, std::int64_t prefix, std::int64_t rest) const;
  at::Tensor whole_frames(const Batch& batch) const;  // features of them
  // Of each frame that is decoded, the features of the frame before it; 0 for the first.
  at::Tensor features_before(const Batch& batch) const;
  std::int64_t frames_decoded(const Batch& batch) const;
  at::Tensor draw_order() const;                           // of joints, (J)
  at::Tensor fixed_order(const at::Device& device) const;  // of joints, (J)
  static at::Tensor channels_of(const at::Tensor& order);  // (J) -> (C)
  // A column of the batch at these places of each frame, (B * frames * places).
  at::Tensor column(const Batch& batch, const at::Tensor& all, const at::Tensor& places) const;
  // What is known of each joint before a frame, (B, frames, J, width); `features` of the frames
  // before, here and below.
  at::Tensor joint_past(const at::Tensor& hidden, const at::Tensor& features,
                        const Batch& batch) const;
  // States of the joint decoder, (B * frames, J, width), the joints of a frame in this order.
  at::Tensor joint_states(const at::Tensor& hidden, const at::Tensor& features, const Batch& batch,
                          const at::Tensor& order) const;
  // Final normalised states, (B * frames * C, width), the channels in the order of their joints.
  at::Tensor decode(const at::Tensor& hidden, const Batch& batch, const at::Tensor& order) const;

  // Of what is already chosen of a frame: row 0 for nothing, then bins, or distances from the
  // extrapolation, of a joint's first, second, third channel.
  struct ChosenTables {
    at::Tensor bin, surprise;
  };
  // Adds what the `which`-th channel of a joint was, read at these places of each frame, where it
  // is known, 0 or 1: (places), or a multiple for several rows a place.
  void look_up_chosen(const ChosenTables& tables, const Batch& batch, const at::Tensor& places,
                      std::int64_t which, const at::Tensor& known,
                      std::vector<Lookup>& lookups) const;

  struct JointTables {
    at::Tensor joint, time, before;
    ChosenTables chosen;
  };
  struct ChannelTables {
    at::Tensor channel, velocity, last_surprise;
    ChosenTables chosen;
  };

  std::vector<std::int64_t> order_;
  at::Tensor token_, position_, ln_w_, ln_b_;
  LinearWeights frame_in_, joint_in_, own_in_, channel_in_, channel_own_in_;
  std::vector<BlockWeights> blocks_, memory_, decoder_;
  JointTables joint_;
  ChannelTables channel_;
  FeedForwardWeights feed_forward_;
  at::Tensor last_ln_w_, last_ln_b_;
};

}  // namespace mocaplm
