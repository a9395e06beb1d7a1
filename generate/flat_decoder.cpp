#include "generate/flat_decoder.h"

#include <algorithm>

namespace mocaplm {

void FlatDecoder::begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
                        const std::vector<std::int32_t>& before) {
  engine_.reset(sequence);
  const auto s = static_cast<std::size_t>(sequence);
  streams_[s] = {prefix, before, before.size()};
  pending_[s] = window_input(description(), prefix, before, before.size(), 0);
}

void FlatDecoder::push(std::int64_t sequence, std::int32_t id) {
  const auto s = static_cast<std::size_t>(sequence);
  Stream& stream = streams_[s];
  const auto waiting = static_cast<std::int64_t>(pending_[s].size());
  if (engine_.length(sequence) + waiting >= engine_.capacity()) slide(sequence, stream);
  stream.ids.push_back(id);
  append_stream(pending_[s], description(), stream.ids, stream.first, stream.ids.size() - 1);
}

// Whole frames at a time.
void FlatDecoder::slide(std::int64_t sequence, Stream& stream) {
  const auto per_frame = static_cast<std::size_t>(description().shape.tokens_per_frame());
  const std::size_t room =
      (static_cast<std::size_t>(engine_.capacity()) - stream.prefix.size()) / per_frame;
  const std::size_t done = stream.ids.size() / per_frame;
  stream.first = (done - std::min(done, room / 2)) * per_frame;
  engine_.reset(sequence);
  pending_[static_cast<std::size_t>(sequence)] = window_input(
      description(), stream.prefix, stream.ids, stream.first, stream.ids.size() - stream.first);
}

const std::vector<std::vector<float>>& FlatDecoder::logits(
    const std::vector<std::int64_t>& sequences) {
  return engine_.feed(sequences, pending_);
}

}  // namespace mocaplm
