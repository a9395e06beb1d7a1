#include "train/corpus.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/parallel.h"
#include "model/masked_input.h"
#include "motion/mirror.h"
#include "motion/turn.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

constexpr std::size_t kFewestFrames = 3;

EncodedClip encode_clip(const Clip& clip, const StreamEncoding& encoding, EncodeReport& report) {
  EncodedClip out;
  out.name = clip.name;
  out.ids = encoding.tokenizer.encode(clip, &report).ids;
  out.values = clip.labels;
  std::vector<std::int32_t> prefix =
      condition_prefix(encoding.tokenizer, encoding.conditions, clip.labels);
  if (encoding.pieces != nullptr && encoding.pieces->any()) {
    out.pieces = encoding.pieces->encode(out.ids);
    prefix = encoding.pieces->ids(std::move(prefix));
  }
  out.labels.assign(prefix.begin() + 1, prefix.end());
  return out;
}

// The stream with the hidden channels of all frames masked; nothing else changes.
std::vector<std::int32_t> without_channels(std::vector<std::int32_t> ids,
                                           const std::vector<bool>& hidden, std::size_t per_frame) {
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (i % per_frame < hidden.size() && hidden[i % per_frame]) ids[i] = Tokenizer::kMask;
  return ids;
}

}  // namespace

Clip augmented(const Clip& clip, const std::string& name, const Augmentation& augmentation) {
  Random random(stable_hash("augmented " + name, augmentation.seed));
  const double angle = random.uniform() * kTurn, exponent = random.uniform(-1, 1);
  Clip out = augmentation.heading ? turned(clip, angle) : clip;
  // A clip of more frames a second than it has plays faster.
  if (augmentation.speed > 1) out.fps *= std::pow(augmentation.speed, exponent);
  return out;
}

Corpus encode_split(const Dataset& dataset, const std::string& split,
                    const StreamEncoding& encoding, bool mirror_too, int threads,
                    const Augmentation& augmentation, const std::atomic<bool>* stop) {
  const std::vector<DatasetEntry> entries = dataset.split(split);
  const std::size_t copies = mirror_too ? 2 : 1;
  std::vector<EncodedClip> encoded(entries.size() * copies);
  std::vector<EncodeReport> reports(encoded.size());
  parallel_for(entries.size(), threads, [&](std::size_t i) {
    if (stop != nullptr && *stop) return;
    const Clip clip = load_clip(dataset, entries[i]);
    const auto encode = [&](std::size_t at, const Clip& one, const std::string& name) {
      encoded[at] = encode_clip(augmentation.any() ? augmented(one, name, augmentation) : one,
                                encoding, reports[at]);
      encoded[at].name = name;
    };
    encode(i, clip, clip.name);
    if (mirror_too) encode(entries.size() + i, mirror(clip), clip.name + " (mirrored)");
  });
  Corpus corpus;
  const auto per_frame = static_cast<std::size_t>(encoding.tokenizer.tokens_per_frame());
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    const std::size_t frames = encoded[i].ids.size() / per_frame;
    if (frames < kFewestFrames) {
      if (i < entries.size()) ++corpus.left_out;
      continue;
    }
    corpus.frames += static_cast<std::int64_t>(frames);
    corpus.report.add(reports[i]);
    corpus.clips.push_back(std::move(encoded[i]));
  }
  if (corpus.clips.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "the split \"" + split + "\" has " + std::to_string(entries.size()) +
                        " clips, none of at least " + std::to_string(kFewestFrames) + " frames");
  return corpus;
}

double predicted_per_frame(const Corpus& corpus, const ModelDescription& model) {
  if (!model.has_pieces()) return static_cast<double>(model.predicted_per_frame());
  double tokens = 0;
  for (const EncodedClip& clip : corpus.clips)
    tokens += static_cast<double>(clip.pieces.tokens.size());
  return tokens / static_cast<double>(corpus.frames);
}

std::size_t window_frames(const ModelDescription& model, std::int64_t reserve) {
  return static_cast<std::size_t>(frames_in_window(model, reserve));
}

namespace {

void fill_causal(Window& window, const ModelDescription& model,
                 const std::vector<std::int32_t>& prefix, const std::vector<std::int32_t>& ids,
                 std::size_t first, std::size_t count, const std::vector<bool>& hidden) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  if (hidden.empty()) {
    window.input = window_input(model, prefix, ids, first, count);
  } else {  // with the frames before it that its first ones are told of
    const std::size_t past = std::min(first, 3 * per_frame);
    const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(first);
    std::vector<std::int32_t> some(begin - static_cast<std::ptrdiff_t>(past),
                                   begin + static_cast<std::ptrdiff_t>(count));
    // The token after the last is asked for: its channel's past is looked up by its index.
    window.input = window_input(model, prefix, without_channels(std::move(some), hidden, per_frame),
                                past, count);
  }
  for (std::size_t i = 0; i <= count && first + i < ids.size(); ++i) {
    const std::size_t channel = i % per_frame;
    const bool asked = channel >= hidden.size() || !hidden[channel];
    window.target[prefix.size() - 1 + i] = asked ? ids[first + i] : -1;
  }
}

void fill_masked(Window& window, const ModelDescription& model,
                 const std::vector<std::int32_t>& prefix, const std::vector<std::int32_t>& ids,
                 std::size_t first, std::size_t count, const std::vector<bool>& hidden,
                 const WindowOptions& options, Random& random) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(first);
  std::vector<std::int32_t> shown(begin, begin + static_cast<std::ptrdiff_t>(count));
  const std::vector<bool> mask = draw_mask(model.shape, count, options, random);
  shown = without_channels(std::move(shown), hidden, per_frame);
  for (std::size_t i = 0; i < count; ++i) {
    const bool away = i % per_frame < hidden.size() && hidden[i % per_frame];
    if (!mask[i] || away) continue;
    shown[i] = Tokenizer::kMask;
    window.target[prefix.size() + i] = ids[first + i];
  }
  window.input = masked_input(model, prefix, shown);
}

void fill_pieces(Window& window, const ModelDescription& model,
                 const std::vector<std::int32_t>& prefix, const EncodedClip& clip) {
  const PieceStream& pieces = clip.pieces;
  const std::size_t first = pieces.frames[window.first_frame];
  const std::size_t room = window.target.size() - prefix.size();
  const std::size_t count = std::min(room, pieces.tokens.size() - first);
  window.frames = pieces.frames_within(window.first_frame, room);
  window.size = prefix.size() + count;
  window.input =
      piece_window_input(model, prefix, {clip.ids, pieces.tokens, pieces.starts}, first, count);
  for (std::size_t i = 0; i <= count && first + i < pieces.tokens.size(); ++i)
    window.target[prefix.size() - 1 + i] = pieces.tokens[first + i];
}

// The last frame from which a window is as full as it can be.
std::size_t last_start(const EncodedClip& clip, const ModelDescription& model) {
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  if (!model.has_pieces()) {
    const std::size_t frames = clip.ids.size() / per_frame, inside = window_frames(model);
    return frames > inside ? frames - inside : 0;
  }
  const std::vector<std::size_t>& frames = clip.pieces.frames;
  const auto room = static_cast<std::size_t>(model.config.block_size - model.prefix());
  const std::size_t first = frames.back() - std::min(frames.back(), room);
  return static_cast<std::size_t>(std::upper_bound(frames.begin(), frames.end(), first) -
                                  frames.begin()) -
         1;
}

}  // namespace

Window make_window(const Corpus& corpus, const ModelDescription& model, std::size_t clip_index,
                   std::size_t first_frame, const WindowOptions& options, Random& random,
                   std::int64_t reserve) {
  const EncodedClip& clip = corpus.clips[clip_index];
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  std::vector<std::int32_t> prefix = {Tokenizer::kStart};
  for (const std::int32_t label : clip.labels)
    prefix.push_back(options.condition_dropout > 0 && random.uniform() < options.condition_dropout
                         ? Tokenizer::kMask
                         : label);
  const auto length = static_cast<std::size_t>(tokens_in_window(model, reserve));
  const std::size_t first = first_frame * per_frame;
  assert(first < clip.ids.size());
  std::size_t room = length - prefix.size();
  // A masked model sees padding, too: then what does not fill a frame is always padding.
  if (model.masked()) room -= room % per_frame;
  const std::size_t count = std::min(room, clip.ids.size() - first);
  Window window;
  window.clip = clip_index;
  window.first_frame = first_frame;
  window.frames = count / per_frame;
  window.size = prefix.size() + count;
  window.target.assign(length, -1);
  const std::vector<bool> hidden = draw_hidden_channels(model.shape, options, random);
  if (model.has_pieces())
    fill_pieces(window, model, prefix, clip);
  else if (model.masked())
    fill_masked(window, model, prefix, clip.ids, first, count, hidden, options, random);
  else
    fill_causal(window, model, prefix, clip.ids, first, count, hidden);
  while (window.input.size() < length)
    append_prefix(window.input, model, Tokenizer::kPad, false, clip.ids, first);
  return window;
}

WindowSampler::WindowSampler(const Corpus& corpus, const ModelDescription& model)
    : corpus_(corpus), model_(model) {
  double sum = 0;
  for (const EncodedClip& clip : corpus.clips)
    cumulative_.push_back(sum += clip.weight * static_cast<double>(clip.ids.size()));
}

Window WindowSampler::draw(Random& random, const WindowOptions& options) const {
  const double at = random.uniform() * cumulative_.back();
  const auto clip = static_cast<std::size_t>(
      std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at) - cumulative_.begin());
  const std::size_t starts = last_start(corpus_.clips[clip], model_) + 1;
  return make_window(corpus_, model_, clip, random.below(starts), options, random);
}

std::vector<Window> even_windows(const Corpus& corpus, const ModelDescription& model,
                                 std::int64_t count) {
  std::vector<std::pair<std::size_t, std::size_t>> places;  // clip, first frame
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  const auto room = static_cast<std::size_t>(model.config.block_size - model.prefix());
  for (std::size_t c = 0; c < corpus.clips.size(); ++c)
    for (std::size_t f = 0; f + kFewestFrames <= corpus.clips[c].ids.size() / per_frame;
         f +=
         model.has_pieces() ? corpus.clips[c].pieces.frames_within(f, room) : window_frames(model))
      places.emplace_back(c, f);
  const std::size_t wanted = std::min(places.size(), static_cast<std::size_t>(count));
  std::vector<Window> windows;
  Random random(0);  // only what a masked model must fill in is drawn
  for (std::size_t i = 0; i < wanted; ++i) {
    const auto [clip, frame] = places[i * places.size() / wanted];
    windows.push_back(make_window(corpus, model, clip, frame, {}, random));
  }
  return windows;
}

}  // namespace mocaplm
