// "architecture": "frames" as a Decoder (model/transformer/frame_transformer.h): a step of the time
// model a frame, and a step of the channel decoder a channel that is to be chosen.
#pragma once

#include "generate/blocks.h"
#include "generate/decoder.h"
#include "generate/frame_stream_state.h"
#include "generate/output_layer.h"

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
  struct ChannelTables {
    ChannelTables(Weights& weights, const ModelDescription& description);
    std::vector<float> channel, before, chosen, surprise, velocity, last_surprise;
  };

  FrameDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options,
               const TensorMap& tensors);
  FrameDecoder(const StoredModel& model, const std::string& place, const EngineOptions& options,
               Weights&& weights);
  void check(const StoredModel& model, const std::string& place);

  FrameStreamState& at(std::int64_t sequence) {
    return streams_[static_cast<std::size_t>(sequence)];
  }
  // The time model over the frames it has not seen yet, then each channel's input.
  void catch_up(const Sequences& sequences);
  void feed_prefix(std::int64_t sequence);
  bool feed_frames(const Sequences& sequences);
  void keep_state(FrameStreamState& stream, std::int64_t row) const;
  void prepare_channels(const Sequences& sequences);
  void add_own(const float* features, float* own, LinearScratch& scratch) const;
  // The channel decoder over what was pushed of the frame, and the place of the next channel.
  void run_channels(const Sequences& sequences);
  void put_channel(FrameStreamState& stream, std::size_t place, float* x) const;

  ModelDescription description_;
  EngineOptions options_;
  Team team_;
  Arena arena_;
  TimeTables time_tables_;
  PackedLinear frame_in_;
  BlockStack time_;
  PackedLinear channel_in_, own_in_;
  ChannelTables tables_;
  BlockStack channels_;
  OutputLayer output_;
  std::vector<FrameStreamState> streams_;
  // Reused: a thread's own, and (rows, ...) that are computed together.
  std::vector<LinearScratch> scratch_;
  std::vector<float> features_, embedded_, states_, own_, last_, normed_;
};

}  // namespace mocaplm
