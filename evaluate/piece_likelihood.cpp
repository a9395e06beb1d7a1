// Bits per frame of models of pieces.
#include <algorithm>
#include <cmath>

#include "evaluate/likelihood.h"

namespace mocaplm {

namespace {

// Whole frames [first, last) of one clip, of which [scored, last) count.
struct PieceWindow {
  std::size_t clip, first, scored, last;
};

std::vector<PieceWindow> cut(const std::vector<ScoredClip>& clips, const ModelDescription& model) {
  std::vector<PieceWindow> windows;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const PieceStream& pieces = clips[c].pieces;
    const std::size_t room =
        static_cast<std::size_t>(model.config.block_size) - clips[c].prefix.size();
    for (std::size_t first = 0, scored = 0; scored < pieces.frame_count();) {
      const std::size_t last = first + pieces.frames_within(first, room);
      windows.push_back({c, first, scored, last});
      scored = last;
      // The next window shows as many frames before as fill half of it.
      while (pieces.frames[last] - pieces.frames[first] > room / 2) ++first;
    }
  }
  std::stable_sort(windows.begin(), windows.end(), [&](const PieceWindow& a, const PieceWindow& b) {
    const auto tokens = [&](const PieceWindow& w) {
      return clips[w.clip].pieces.frames[w.last] - clips[w.clip].pieces.frames[w.first];
    };
    return tokens(a) > tokens(b);
  });
  return windows;
}

void share(const PieceStream& pieces, std::size_t token, double bits, BitCount& count) {
  const std::size_t per_frame = count.bits.size(), begin = pieces.starts[token] % per_frame;
  const std::size_t end = begin + pieces.starts[token + 1] - pieces.starts[token];
  // The separator at the end of a piece has no share.
  const std::size_t last = end == per_frame && begin + 1 < end ? end - 1 : end;
  for (std::size_t c = begin; c < last; ++c)
    count.bits[c] += bits / static_cast<double>(last - begin);
}

}  // namespace

std::vector<BitCount> score_piece_clips(LanguageModel& model, const std::vector<ScoredClip>& clips,
                                        std::int64_t windows_at_once, const WindowsDone& progress) {
  const at::NoGradGuard no_grad;
  model.eval();
  const ModelDescription& d = model.description();
  const at::Device device = model.parameters().front().device();
  std::vector<BitCount> counts(clips.size());
  for (std::size_t c = 0; c < clips.size(); ++c) {
    counts[c].frames = static_cast<std::int64_t>(clips[c].pieces.frame_count());
    counts[c].bits.assign(static_cast<std::size_t>(d.shape.tokens_per_frame()), 0);
  }
  const std::vector<PieceWindow> windows = cut(clips, d);
  const auto at_once = static_cast<std::size_t>(windows_at_once);
  for (std::size_t i = 0; i < windows.size(); i += at_once) {
    const std::size_t end = std::min(i + at_once, windows.size());
    std::vector<ModelInput> inputs;
    std::vector<std::vector<std::int32_t>> targets;
    std::size_t length = 0;  // the first of the sorted windows is the longest but for its prefix
    for (std::size_t w = i; w < end; ++w) {
      const ScoredClip& clip = clips[windows[w].clip];
      const PieceStream& pieces = clip.pieces;
      const std::size_t first = pieces.frames[windows[w].first];
      // The last token predicts nothing that is scored.
      inputs.push_back(piece_window_input(d, clip.prefix, {clip.ids, pieces.tokens, pieces.starts},
                                          first, pieces.frames[windows[w].last] - first - 1));
      length = std::max(length, inputs.back().size());
    }
    for (std::size_t w = i; w < end; ++w) {
      const ScoredClip& clip = clips[windows[w].clip];
      const std::vector<std::size_t>& frames = clip.pieces.frames;
      while (inputs[w - i].size() < length)
        append_prefix(inputs[w - i], d, Tokenizer::kPad, false, clip.ids, 0);
      targets.emplace_back(length, -1);
      for (std::size_t t = frames[windows[w].scored]; t < frames[windows[w].last]; ++t)
        targets.back()[clip.prefix.size() - 1 + t - frames[windows[w].first]] =
            clip.pieces.tokens[t];
    }
    const Batch batch = stack(inputs, targets).to(device);
    const at::Tensor nats = model.loss(model.hidden(batch), batch).to(at::kCPU).contiguous();
    for (std::size_t w = i; w < end; ++w) {
      const PieceWindow& one = windows[w];
      const ScoredClip& clip = clips[one.clip];
      const float* row = nats.data_ptr<float>() + static_cast<std::int64_t>(w - i) * nats.size(1) +
                         clip.prefix.size() - 1;
      const std::vector<std::size_t>& frames = clip.pieces.frames;
      for (std::size_t t = frames[one.scored]; t < frames[one.last]; ++t)
        share(clip.pieces, t, row[t - frames[one.first]] / std::log(2.0), counts[one.clip]);
    }
    if (progress) progress(end, windows.size());
  }
  return counts;
}

}  // namespace mocaplm
