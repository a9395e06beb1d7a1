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

std::vector<PieceWindow> cut_pieces(const std::vector<ScoredClip>& clips,
                                    const ModelDescription& model) {
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

// The positions of one window, and as targets the tokens of the frames that count in it. The last
// token predicts nothing that is scored.
void add_window(const ModelDescription& model, const ScoredClip& clip, const PieceWindow& window,
                std::vector<ModelInput>& inputs, std::vector<std::vector<std::int32_t>>& targets) {
  const PieceStream& pieces = clip.pieces;
  const std::size_t first = pieces.frames[window.first], last = pieces.frames[window.last];
  inputs.push_back(piece_window_input(model, clip.prefix, {clip.ids, pieces.tokens, pieces.starts},
                                      first, last - first - 1));
  std::vector<std::int32_t> target(inputs.back().size(), -1);
  for (std::size_t t = pieces.frames[window.scored]; t < last; ++t)
    target[clip.prefix.size() - 1 + t - first] = pieces.tokens[t];
  targets.push_back(std::move(target));
}

// Windows of one batch, padded to the longest of them.
Batch batch_of(const ModelDescription& model, const std::vector<ScoredClip>& clips,
               const PieceWindow* begin, const PieceWindow* end) {
  std::vector<ModelInput> inputs;
  std::vector<std::vector<std::int32_t>> targets;
  std::size_t length = 0;
  for (const PieceWindow* window = begin; window != end; ++window) {
    add_window(model, clips[window->clip], *window, inputs, targets);
    length = std::max(length, inputs.back().size());
  }
  for (std::size_t w = 0; w < inputs.size(); ++w) {
    const std::vector<std::int32_t>& ids = clips[begin[w].clip].ids;
    while (inputs[w].size() < length)
      append_prefix(inputs[w], model, Tokenizer::kPad, false, ids, 0);
    targets[w].resize(length, -1);
  }
  return stack(inputs, targets);
}

// `nats`: of the window's positions from the prefix's last on, which predicts its first token.
void count_window(const PieceStream& pieces, const PieceWindow& window, const float* nats,
                  BitCount& count) {
  const std::size_t first = pieces.frames[window.first];
  for (std::size_t t = pieces.frames[window.scored]; t < pieces.frames[window.last]; ++t)
    share(pieces, t, nats[t - first] / std::log(2.0), count);
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
  const std::vector<PieceWindow> windows = cut_pieces(clips, d);
  const auto at_once = static_cast<std::size_t>(windows_at_once);
  for (std::size_t i = 0; i < windows.size(); i += at_once) {
    const std::size_t end = std::min(i + at_once, windows.size());
    const Batch batch = batch_of(d, clips, windows.data() + i, windows.data() + end).to(device);
    const at::Tensor nats = model.loss(model.hidden(batch), batch).to(at::kCPU).contiguous();
    for (std::size_t w = i; w < end; ++w) {
      const ScoredClip& clip = clips[windows[w].clip];
      const float* row = nats.data_ptr<float>() + static_cast<std::int64_t>(w - i) * nats.size(1);
      count_window(clip.pieces, windows[w], row + clip.prefix.size() - 1, counts[windows[w].clip]);
    }
    if (progress) progress(end, windows.size());
  }
  return counts;
}

}  // namespace mocaplm
