#include "model/input.h"

#include <algorithm>
#include <cassert>

namespace mocaplm {

std::int32_t StreamHistory::bin(const std::vector<std::int32_t>& ids, std::size_t index,
                                std::size_t frames) const {
  const std::size_t back = frames * static_cast<std::size_t>(shape_.tokens_per_frame());
  if (index < back || index - back >= ids.size()) return kNoCentre;
  const std::int64_t bin = ids[index - back] - shape_.first_bin;
  return bin < 0 || bin >= shape_.bins ? kNoCentre : static_cast<std::int32_t>(bin);
}

std::int32_t StreamHistory::row(std::int64_t distance) const {
  return static_cast<std::int32_t>(std::clamp(distance, -reach_, reach_) + reach_ + 1);
}

std::int32_t StreamHistory::centre(const std::vector<std::int32_t>& ids, std::size_t index) const {
  const std::int32_t one = bin(ids, index, 1), two = bin(ids, index, 2);
  if (one == kNoCentre) return kNoCentre;
  return two == kNoCentre ? one : 2 * one - two;
}

std::int32_t StreamHistory::surprise_row(const std::vector<std::int32_t>& ids,
                                         std::size_t index) const {
  const std::int32_t now = bin(ids, index, 0), expected = centre(ids, index);
  return now == kNoCentre || expected == kNoCentre ? 0 : row(now - expected);
}

std::int32_t StreamHistory::velocity_row(const std::vector<std::int32_t>& ids,
                                         std::size_t index) const {
  const std::int32_t one = bin(ids, index, 1), two = bin(ids, index, 2);
  return one == kNoCentre || two == kNoCentre ? 0 : row(one - two);
}

std::int32_t StreamHistory::last_surprise_row(const std::vector<std::int32_t>& ids,
                                              std::size_t index) const {
  const auto frame = static_cast<std::size_t>(shape_.tokens_per_frame());
  return index < frame ? 0 : surprise_row(ids, index - frame);
}

namespace {

void append_next(ModelInput& input, const ModelDescription& model,
                 const std::vector<std::int32_t>& ids, std::size_t next) {
  const StreamHistory history(model.shape, model.config.reach);
  input.centre.push_back(history.centre(ids, next));
  input.velocity.push_back(history.velocity_row(ids, next));
  input.last_surprise.push_back(history.last_surprise_row(ids, next));
}

}  // namespace

void append_prefix(ModelInput& input, const ModelDescription& model, std::int32_t token, bool last,
                   const std::vector<std::int32_t>& ids, std::size_t first) {
  input.token.push_back(token);
  input.frame.push_back(0);
  input.channel.push_back(static_cast<std::int32_t>(model.shape.channels + 1));
  input.surprise.push_back(0);
  if (last) {
    append_next(input, model, ids, first);
  } else {
    input.centre.push_back(kNoCentre);
    input.velocity.push_back(0);
    input.last_surprise.push_back(0);
  }
}

void append_stream(ModelInput& input, const ModelDescription& model,
                   const std::vector<std::int32_t>& ids, std::size_t first, std::size_t index) {
  append_piece(input, model, ids, first, index, ids[index], 1);
}

void append_piece(ModelInput& input, const ModelDescription& model,
                  const std::vector<std::int32_t>& ids, std::size_t first, std::size_t index,
                  std::int32_t token, std::size_t length) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  assert(first % per_frame == 0 && index >= first && index + length <= ids.size());
  assert(length >= 1 && length <= static_cast<std::size_t>(model.shape.longest));
  input.token.push_back(token);
  input.frame.push_back(static_cast<std::int32_t>(1 + (index - first) / per_frame));
  input.channel.push_back(
      static_cast<std::int32_t>(index % per_frame + (per_frame + 1) * (length - 1)));
  input.surprise.push_back(StreamHistory(model.shape, model.config.reach).surprise_row(ids, index));
  append_next(input, model, ids, index + length);
}

ModelInput slice(const ModelInput& input, std::size_t begin, std::size_t end) {
  ModelInput out;
  for (auto list :
       {&ModelInput::token, &ModelInput::frame, &ModelInput::channel, &ModelInput::centre,
        &ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    (out.*list).assign((input.*list).begin() + static_cast<std::ptrdiff_t>(begin),
                       (input.*list).begin() + static_cast<std::ptrdiff_t>(end));
  return out;
}

ModelInput window_input(const ModelDescription& model, const std::vector<std::int32_t>& prefix,
                        const std::vector<std::int32_t>& ids, std::size_t first,
                        std::size_t count) {
  ModelInput input;
  for (std::size_t p = 0; p < prefix.size(); ++p)
    append_prefix(input, model, prefix[p], p + 1 == prefix.size(), ids, first);
  for (std::size_t i = first; i < first + count; ++i) append_stream(input, model, ids, first, i);
  return input;
}

ModelInput piece_window_input(const ModelDescription& model,
                              const std::vector<std::int32_t>& prefix, const PieceTokens& stream,
                              std::size_t first, std::size_t count) {
  const std::size_t begin = stream.starts[first];
  ModelInput input = window_input(model, prefix, stream.ids, begin, 0);
  for (std::size_t i = first; i < first + count; ++i)
    append_piece(input, model, stream.ids, begin, stream.starts[i], stream.tokens[i],
                 stream.starts[i + 1] - stream.starts[i]);
  return input;
}

}  // namespace mocaplm
