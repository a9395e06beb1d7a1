// One dance in the making: its tokens so far, and the sequence of the decoder that it is made in.
#pragma once

#include <vector>

#include "generate/generator.h"

namespace mocaplm {

class DanceInMaking {
 public:
  DanceInMaking(std::size_t index, const GenerateRequest& request, Decoder& decoder,
                const Tokenizer& tokenizer, const PieceVocabulary& pieces,
                const Generator::OnFrame& on_frame);

  // Takes a sequence of the decoder, from its start.
  void begin(std::int64_t sequence);
  // Goes on as far as the tokens are known: to the next one that must be chosen, or to the end.
  void advance();
  bool done() const { return ids_.size() == plan_.frames * per_frame_; }
  void choose(const std::vector<float>& logits);

  std::int64_t sequence() const { return sequence_; }
  GenerateResult result() const;

 private:
  std::int32_t known() const;
  void push(std::int32_t id);
  void push_piece(std::int32_t id);
  // A frame that the prompt gives as a whole, in the pieces that training cuts it into.
  bool push_known_frame();
  // The tokens that may come next: they fit the frame and agree with the prompt. Single characters
  // always do, so there is one.
  void find_allowed();
  // `told`: the decoder has the separator already, as the end of a piece.
  void end_frame(bool told = false);
  void tell_frame();

  std::size_t index_;
  Labels labels_;
  Decoder& decoder_;
  const Tokenizer& tokenizer_;
  const PieceVocabulary& pieces_;
  const Generator::OnFrame& on_frame_;
  GeneratePlan plan_;
  std::vector<std::int32_t> prefix_, ids_;
  Sampler sampler_;
  std::size_t per_frame_;
  std::int64_t sequence_ = 0;
  std::vector<int> order_;             // of a frame's channels: prompted ones first where possible
  std::vector<std::int32_t> frame_;    // ids of the unfinished frame, by channel
  std::size_t place_ = 0;              // in the order, of the next channel
  std::vector<std::int32_t> allowed_;  // find_allowed's
  std::vector<Eigen::Vector3d> path_;  // of the root so far, for on_frame
};

}  // namespace mocaplm
