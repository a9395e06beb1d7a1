#include "model/masked_input.h"

#include <algorithm>
#include <cmath>

namespace mocaplm {

namespace {

// The known bins of one channel of a window, frame by frame.
class Track {
 public:
  Track(const StreamShape& shape, const std::vector<std::int32_t>& ids, std::size_t channel) {
    const auto per_frame = static_cast<std::size_t>(shape.tokens_per_frame());
    for (std::size_t i = channel; i < ids.size(); i += per_frame) {
      const std::int64_t bin = ids[i] - shape.first_bin;
      bins_.push_back(bin < 0 || bin >= shape.bins ? kNoCentre : static_cast<std::int32_t>(bin));
    }
    const auto frames = static_cast<std::int64_t>(bins_.size());
    before_.assign(bins_.size(), -1);
    after_.assign(bins_.size(), frames);
    for (std::int64_t t = 1; t < frames; ++t)
      at(before_, t) = known(t - 1) ? t - 1 : at(before_, t - 1);
    for (std::int64_t t = frames - 2; t >= 0; --t)
      at(after_, t) = known(t + 1) ? t + 1 : at(after_, t + 1);
  }

  bool known(std::int64_t t) const {
    return t >= 0 && t < static_cast<std::int64_t>(bins_.size()) && bin(t) != kNoCentre;
  }
  std::int32_t bin(std::int64_t t) const { return bins_[static_cast<std::size_t>(t)]; }

  std::int32_t centre(std::int64_t t) const {
    const std::int64_t before = at(before_, t), after = at(after_, t);
    const bool some_before = before >= 0, some_after = known(after);
    if (some_before && some_after) {
      const double share = static_cast<double>(t - before) / static_cast<double>(after - before);
      return static_cast<std::int32_t>(
          std::lround(bin(before) + share * static_cast<double>(bin(after) - bin(before))));
    }
    if (some_before)
      return before == t - 1 && known(t - 2) ? 2 * bin(t - 1) - bin(t - 2) : bin(before);
    if (some_after)
      return after == t + 1 && known(t + 2) ? 2 * bin(t + 1) - bin(t + 2) : bin(after);
    return kNoCentre;
  }

 private:
  using Frames = std::vector<std::int64_t>;
  static std::int64_t& at(Frames& list, std::int64_t t) {
    return list[static_cast<std::size_t>(t)];
  }
  static std::int64_t at(const Frames& list, std::int64_t t) {
    return list[static_cast<std::size_t>(t)];
  }

  std::vector<std::int32_t> bins_;
  Frames before_, after_;  // nearest known frames; -1 and the number of frames where there are none
};

class MaskedHistory {
 public:
  explicit MaskedHistory(std::int64_t reach) : reach_(reach) {}

  void fill(ModelInput& input, std::size_t position, const Track& track, std::int64_t t) const {
    const std::int32_t centre = track.centre(t);
    input.centre[position] = centre;
    if (track.known(t) && centre != kNoCentre)
      input.surprise[position] = row(track.bin(t) - centre);
    if (track.known(t - 1) && track.known(t - 2))
      input.velocity[position] = row(track.bin(t - 1) - track.bin(t - 2));
    if (track.known(t + 1) && track.known(t + 2))
      input.last_surprise[position] = row(track.bin(t + 2) - track.bin(t + 1));
  }

 private:
  std::int32_t row(std::int64_t distance) const {
    return static_cast<std::int32_t>(std::clamp(distance, -reach_, reach_) + reach_ + 1);
  }
  std::int64_t reach_;
};

}  // namespace

ModelInput masked_input(const ModelDescription& model, const std::vector<std::int32_t>& prefix,
                        const std::vector<std::int32_t>& ids) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const auto channels = static_cast<std::size_t>(model.shape.channels);
  ModelInput input;
  for (const std::int32_t token : prefix) append_prefix(input, model, token, false, ids, 0);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    input.token.push_back(ids[i]);
    input.frame.push_back(static_cast<std::int32_t>(1 + i / per_frame));
    input.channel.push_back(static_cast<std::int32_t>(i % per_frame));
  }
  input.centre.resize(input.size(), kNoCentre);
  for (auto list : {&ModelInput::surprise, &ModelInput::velocity, &ModelInput::last_surprise})
    (input.*list).resize(input.size(), 0);
  const MaskedHistory history(model.config.reach);
  for (std::size_t c = 0; c < channels && c < ids.size(); ++c) {
    const Track track(model.shape, ids, c);
    for (std::size_t i = c; i < ids.size(); i += per_frame)
      history.fill(input, prefix.size() + i, track, static_cast<std::int64_t>(i / per_frame));
  }
  return input;
}

std::vector<CentralWindow> central_windows(std::size_t frames, std::size_t room) {
  std::vector<CentralWindow> windows;
  if (frames <= room) return {{0, frames, 0, frames}};
  const std::size_t step = std::max<std::size_t>(room / 2, 1), margin = (room - step) / 2;
  for (std::size_t first = 0, from = 0; from < frames; first += step) {
    const std::size_t begin = std::min(first, frames - room), last = begin + room;
    const std::size_t to = last == frames ? frames : last - margin;
    windows.push_back({begin, last, from, to});
    from = to;
  }
  return windows;
}

}  // namespace mocaplm
