// One dance in the making: its tokens so far, and the sequence of the engine that it is decoded in.
#pragma once

#include <vector>

#include "generate/generator.h"

namespace mocaplm {

class DanceInMaking {
 public:
  DanceInMaking(std::size_t index, const GenerateRequest& request, Engine& engine,
                const Tokenizer& tokenizer, const Generator::OnFrame& on_frame);

  // Takes a sequence of the engine, from its start.
  void begin(std::int64_t sequence);
  // Goes on as far as the tokens are known: to the next one that must be chosen, or to the end.
  void advance();
  bool done() const { return ids_.size() == plan_.frames * per_frame_; }
  // What the engine must be fed before the next token can be chosen.
  Engine::Feed feed() const { return {sequence_, &pending_}; }
  void choose(const std::vector<float>& logits);

  std::int64_t sequence() const { return sequence_; }
  GenerateResult result() const;

 private:
  std::int32_t known() const;
  void push(std::int32_t id);
  void slide();
  void tell_frame();

  std::size_t index_;
  Labels labels_;
  Engine& engine_;
  const Tokenizer& tokenizer_;
  const Generator::OnFrame& on_frame_;
  GeneratePlan plan_;
  std::vector<std::int32_t> prefix_, ids_;
  Sampler sampler_;
  std::size_t per_frame_;
  std::size_t first_ = 0;  // index of the first stream token in the cache, a frame's start
  std::int64_t sequence_ = 0;
  ModelInput pending_;
  std::vector<Eigen::Vector3d> path_;  // of the root so far, for on_frame
};

}  // namespace mocaplm
