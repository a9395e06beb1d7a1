#include "train/corpus.h"

#include <algorithm>
#include <cassert>

#include "common/error.h"
#include "common/parallel.h"
#include "motion/mirror.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

constexpr std::size_t kFewestFrames = 3;

EncodedClip encode_clip(const Clip& clip, const Tokenizer& tokenizer,
                        const std::vector<std::string>& conditions, EncodeReport& report) {
  EncodedClip out;
  out.name = clip.name;
  out.ids = tokenizer.encode(clip, &report).ids;
  out.values = clip.labels;
  const std::vector<std::int32_t> prefix = condition_prefix(tokenizer, conditions, clip.labels);
  out.labels.assign(prefix.begin() + 1, prefix.end());
  return out;
}

}  // namespace

Corpus encode_split(const Dataset& dataset, const std::string& split, const Tokenizer& tokenizer,
                    const std::vector<std::string>& conditions, bool mirror_too, int threads) {
  const std::vector<DatasetEntry> entries = dataset.split(split);
  const std::size_t copies = mirror_too ? 2 : 1;
  std::vector<EncodedClip> encoded(entries.size() * copies);
  std::vector<EncodeReport> reports(encoded.size());
  parallel_for(entries.size(), threads, [&](std::size_t i) {
    const Clip clip = load_clip(dataset, entries[i]);
    encoded[i] = encode_clip(clip, tokenizer, conditions, reports[i]);
    if (!mirror_too) return;
    const std::size_t twin = entries.size() + i;
    encoded[twin] = encode_clip(mirror(clip), tokenizer, conditions, reports[twin]);
    encoded[twin].name += " (mirrored)";
  });
  Corpus corpus;
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    const std::size_t frames = encoded[i].ids.size() / per_frame;
    if (frames < kFewestFrames) {
      if (i < entries.size()) ++corpus.left_out;
      continue;
    }
    corpus.frames += static_cast<std::int64_t>(frames);
    corpus.report.values += reports[i].values;
    corpus.report.clamped += reports[i].clamped;
    corpus.clips.push_back(std::move(encoded[i]));
  }
  if (corpus.clips.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "the split \"" + split + "\" has " + std::to_string(entries.size()) +
                        " clips, none of at least " + std::to_string(kFewestFrames) + " frames");
  return corpus;
}

std::size_t window_frames(const ModelDescription& model, std::int64_t reserve) {
  return static_cast<std::size_t>(frames_in_window(model, reserve));
}

Window make_window(const Corpus& corpus, const ModelDescription& model, std::size_t clip_index,
                   std::size_t first_frame, double condition_dropout, Random& random,
                   std::int64_t reserve) {
  const EncodedClip& clip = corpus.clips[clip_index];
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  std::vector<std::int32_t> prefix = {Tokenizer::kStart};
  for (const std::int32_t label : clip.labels)
    prefix.push_back(
        condition_dropout > 0 && random.uniform() < condition_dropout ? Tokenizer::kMask : label);
  const auto length = static_cast<std::size_t>(tokens_in_window(model, reserve));
  const std::size_t first = first_frame * per_frame;
  assert(first < clip.ids.size());
  const std::size_t count = std::min(length - prefix.size(), clip.ids.size() - first);
  Window window;
  window.clip = clip_index;
  window.first_frame = first_frame;
  window.frames = count / per_frame;
  window.input = window_input(model, prefix, clip.ids, first, count);
  window.target.assign(length, -1);
  for (std::size_t i = 0; i < count; ++i)
    window.target[prefix.size() - 1 + i] = clip.ids[first + i];
  if (first + count < clip.ids.size())
    window.target[prefix.size() - 1 + count] = clip.ids[first + count];
  while (window.input.size() < length)
    append_prefix(window.input, model, Tokenizer::kPad, false, clip.ids, first);
  return window;
}

WindowSampler::WindowSampler(const Corpus& corpus, const ModelDescription& model)
    : corpus_(corpus), model_(model) {
  double sum = 0;
  for (const EncodedClip& clip : corpus.clips)
    cumulative_.push_back(sum += static_cast<double>(clip.ids.size()));
}

Window WindowSampler::draw(Random& random, double condition_dropout) const {
  const double at = random.uniform() * cumulative_.back();
  const auto clip = static_cast<std::size_t>(
      std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at) - cumulative_.begin());
  const std::size_t frames =
      corpus_.clips[clip].ids.size() / static_cast<std::size_t>(model_.shape.tokens_per_frame());
  const std::size_t inside = window_frames(model_);
  const std::size_t starts = frames > inside ? frames - inside + 1 : 1;
  return make_window(corpus_, model_, clip, random.below(starts), condition_dropout, random);
}

std::vector<Window> even_windows(const Corpus& corpus, const ModelDescription& model,
                                 std::int64_t count) {
  std::vector<std::pair<std::size_t, std::size_t>> places;  // clip, first frame
  const auto per_frame = static_cast<std::size_t>(model.shape.tokens_per_frame());
  for (std::size_t c = 0; c < corpus.clips.size(); ++c)
    for (std::size_t f = 0; f + kFewestFrames <= corpus.clips[c].ids.size() / per_frame;
         f += window_frames(model))
      places.emplace_back(c, f);
  const std::size_t wanted = std::min(places.size(), static_cast<std::size_t>(count));
  std::vector<Window> windows;
  Random unused(0);
  for (std::size_t i = 0; i < wanted; ++i) {
    const auto [clip, frame] = places[i * places.size() / wanted];
    windows.push_back(make_window(corpus, model, clip, frame, 0, unused));
  }
  return windows;
}

}  // namespace mocaplm
