// "architecture": "frames" as a Decoder (model/transformer/frame_transformer.h): a step of the time
// model a frame, a step of the joint decoder a joint, and one of the last layer a channel.
#pragma once

#include "generate/blocks.h"
#include "generate/channel_layer.h"
#include "generate/decoder.h"
#include "generate/frame_stream_state.h"

namespace mocaplm {

class FrameDecoder : public Decoder {
 public:
  FrameDecoder(const StoredModel& model, const std::string& place,
               const EngineOptions& options = {});

  const ModelDescription& description() const override { return description_; }
  std::int64_t sequences() const override { return options_.sequences; }
  void begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
             const std::vector<std::int32_t>& before) override;
  bool any_order() const override { return true; }
  void set_order(std::int64_t sequence, const std::vector<int>& channels) override;
  void push(std::int64_t sequence, std::int32_t id) override;
  const std::vector<std::vector<float>>& logits(
      const std::vector<std::int64_t>& sequences) override;

 private:
  using Sequences = std::vector<std::int64_t>;

  struct TimeTables {
    TimeTables(Weights& weights, const ModelDescription& description);
    std::vector<float> token, position;
  };
  struct JointTables {
    JointTables(Weights& weights, const ModelDescription& description);
    std::vector<float> joint, time, before, chosen, surprise;
  };

  FrameDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options,
               const TensorMap& tensors);
  FrameDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options,
               Weights&& weights);
  void check(const StoredModel& model, const std::string& place);

  FrameStreamState& at(std::int64_t sequence) {
    return streams_[static_cast<std::size_t>(sequence)];
  }
  std::int64_t joints() const { return description_.shape.channels / kJointChannels; }
  // The time model over the frames it has not seen yet, then each joint's and channel's input.
  void catch_up(const Sequences& sequences);
  void feed_prefix(std::int64_t sequence);
  bool feed_frames(const Sequences& sequences);
  // The state before a frame of the window, in a row of the time model's last run.
  struct Reached {
    std::int64_t sequence, frame, row;
  };
  void remember(std::vector<Reached> reached);
  void tell_joints(const std::vector<Reached>& reached);
  void remember_sequence(const std::vector<Reached>& reached, std::size_t begin, std::size_t end);
  void reset_past(std::int64_t sequence);
  // The joint decoder up to the joint whose channel comes next.
  void run_joints(const Sequences& sequences);
  void put_joint(const FrameStreamState& stream, std::size_t place, float* x) const;

  ModelDescription description_;
  EngineOptions options_;
  Team team_;
  Arena arena_;
  TimeTables time_tables_;
  PackedLinear frame_in_;
  BlockStack time_;
  PackedLinear joint_in_, own_in_;
  JointTables tables_;
  BlockStack memory_;  // a sequence a joint
  BlockStack joints_;
  ChannelLayer channels_;
  std::vector<FrameStreamState> streams_;
  // Reused: a thread's own, and (rows, ...) that are computed together.
  std::vector<LinearScratch> scratch_;
  std::vector<float> features_, embedded_, states_, own_, last_;
};

}  // namespace mocaplm
