#include "evaluate/likelihood.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace mocaplm {

namespace {

// A window of whole frames [first, last) of one clip, of which [scored, last) count.
struct ScoredWindow {
  std::size_t clip, first, scored, last;
};

std::vector<ScoredWindow> cut_windows(const std::vector<ScoredClip>& clips,
                                      const ModelDescription& model) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  std::vector<ScoredWindow> pieces;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const auto room = static_cast<std::size_t>(frames_in_window(model));
    const std::size_t frames = clips[c].ids.size() / per_frame;
    for (std::size_t first = 0, scored = 0; scored < frames;
         first += std::max<std::size_t>(room / 2, 1)) {
      const std::size_t last = std::min(first + room, frames);
      pieces.push_back({c, first, scored, last});
      scored = last;
    }
  }
  // Windows of like length share a batch, so that little is padding.
  std::stable_sort(pieces.begin(), pieces.end(), [](const ScoredWindow& a, const ScoredWindow& b) {
    return a.last - a.first > b.last - b.first;
  });
  return pieces;
}

ModelInput padded_input(const ModelDescription& model, const ScoredClip& clip,
                        const ScoredWindow& piece, std::size_t length) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const std::size_t first = piece.first * per_frame;
  // The last token predicts nothing that is scored.
  ModelInput input =
      window_input(model, clip.prefix, clip.ids, first, (piece.last - piece.first) * per_frame - 1);
  while (input.size() < length) append_prefix(input, model, 0, false, clip.ids, first);
  return input;
}

std::vector<std::int32_t> padded_target(const ModelDescription& model, const ScoredClip& clip,
                                        const ScoredWindow& piece, std::size_t length) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  std::vector<std::int32_t> target(length, -1);
  for (std::size_t i = piece.scored * per_frame; i < piece.last * per_frame; ++i)
    target[clip.prefix.size() - 1 + i - piece.first * per_frame] = clip.ids[i];
  return target;
}

// Nats of every token of several windows, from the first frame of each on; `length` is that of the
// longest with its prefix. What comes before a window's scored frames is not looked at.
using WindowNats = std::function<std::vector<std::vector<float>>(
    const std::vector<ScoredWindow>& pieces, std::size_t length)>;

std::vector<BitCount> score_windows(const ModelDescription& d, const std::vector<ScoredClip>& clips,
                                    std::int64_t windows_at_once, const WindowNats& window_nats,
                                    const WindowsDone& progress) {
  const auto per_frame = static_cast<std::size_t>(d.shape.tokens_per_frame());
  const std::vector<ScoredWindow> pieces = cut_windows(clips, d);
  std::vector<BitCount> counts(clips.size());
  for (std::size_t c = 0; c < clips.size(); ++c) {
    counts[c].frames = static_cast<std::int64_t>(clips[c].ids.size() / per_frame);
    counts[c].bits.assign(per_frame, 0);
  }
  const auto at_once = static_cast<std::size_t>(windows_at_once);
  for (std::size_t i = 0; i < pieces.size(); i += at_once) {
    const std::size_t end = std::min(i + at_once, pieces.size());
    const std::vector<ScoredWindow> some(pieces.begin() + static_cast<std::ptrdiff_t>(i),
                                         pieces.begin() + static_cast<std::ptrdiff_t>(end));
    std::size_t length = 0;
    for (const ScoredWindow& piece : some)
      length = std::max(
          length, clips[piece.clip].prefix.size() + (piece.last - piece.first) * per_frame - 1);
    const std::vector<std::vector<float>> nats = window_nats(some, length);
    for (std::size_t w = 0; w < some.size(); ++w)
      for (std::size_t t = (some[w].scored - some[w].first) * per_frame;
           t < (some[w].last - some[w].first) * per_frame; ++t)
        counts[some[w].clip].bits[t % per_frame] += nats[w][t] / std::log(2.0);
    if (progress) progress(end, pieces.size());
  }
  return counts;
}

float nats_of(const std::vector<float>& logits, std::int32_t id) {
  const float top = *std::max_element(logits.begin(), logits.end());
  double sum = 0;
  for (const float logit : logits) sum += std::exp(static_cast<double>(logit) - top);
  return static_cast<float>(std::log(sum) + top - logits[static_cast<std::size_t>(id)]);
}

}  // namespace

std::vector<BitCount> score_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                  std::int64_t windows_at_once, const WindowsDone& progress) {
  if (model.description().has_pieces())
    return score_piece_clips(model, clips, windows_at_once, progress);
  const at::NoGradGuard no_grad;
  model.eval();
  const at::Device device = model.parameters().front().device();
  const auto window_nats = [&](const std::vector<ScoredWindow>& pieces, std::size_t length) {
    std::vector<ModelInput> inputs;
    std::vector<std::vector<std::int32_t>> targets;
    for (const ScoredWindow& piece : pieces) {
      inputs.push_back(padded_input(model.description(), clips[piece.clip], piece, length));
      targets.push_back(padded_target(model.description(), clips[piece.clip], piece, length));
    }
    const Batch batch = stack(inputs, targets).to(device);
    const at::Tensor nats = model.loss(model.hidden(batch), batch).to(at::kCPU).contiguous();
    std::vector<std::vector<float>> rows;
    for (std::size_t w = 0; w < pieces.size(); ++w) {
      const float* row = nats.data_ptr<float>() + static_cast<std::int64_t>(w) * nats.size(1);
      rows.emplace_back(row + clips[pieces[w].clip].prefix.size() - 1, row + nats.size(1));
    }
    return rows;
  };
  return score_windows(model.description(), clips, windows_at_once, window_nats, progress);
}

std::vector<BitCount> score_clips(Decoder& decoder, const std::vector<ScoredClip>& clips,
                                  const WindowsDone& progress) {
  const ModelDescription& d = decoder.description();
  const auto per_frame = static_cast<std::size_t>(d.shape.tokens_per_frame());
  const auto window_nats = [&](const std::vector<ScoredWindow>& pieces, std::size_t) {
    std::vector<std::vector<float>> rows(pieces.size());
    std::size_t longest = 0;
    for (std::size_t w = 0; w < pieces.size(); ++w) {
      const ScoredWindow& piece = pieces[w];
      const ScoredClip& clip = clips[piece.clip];
      const auto begin = clip.ids.begin();
      decoder.begin(static_cast<std::int64_t>(w), clip.prefix,
                    {begin, begin + static_cast<std::ptrdiff_t>(piece.first * per_frame)});
      rows[w].assign((piece.last - piece.first) * per_frame, 0.f);
      longest = std::max(longest, rows[w].size());
    }
    for (std::size_t t = 0; t < longest; ++t) {
      std::vector<std::int64_t> asked;
      for (std::size_t w = 0; w < pieces.size(); ++w)
        if (t % per_frame + 1 < per_frame && t < rows[w].size() &&
            t >= (pieces[w].scored - pieces[w].first) * per_frame)
          asked.push_back(static_cast<std::int64_t>(w));
      const auto id = [&](std::size_t w) {
        return clips[pieces[w].clip].ids[pieces[w].first * per_frame + t];
      };
      if (!asked.empty()) {
        const auto& logits = decoder.logits(asked);
        for (std::size_t i = 0; i < asked.size(); ++i) {
          const auto w = static_cast<std::size_t>(asked[i]);
          rows[w][t] = nats_of(logits[i], id(w));
        }
      }
      for (std::size_t w = 0; w < pieces.size(); ++w)
        if (t + 1 < rows[w].size()) decoder.push(static_cast<std::int64_t>(w), id(w));
    }
    return rows;
  };
  return score_windows(d, clips, decoder.sequences(), window_nats, progress);
}

}  // namespace mocaplm
