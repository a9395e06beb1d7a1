#include "classify/windows.h"

#include <algorithm>
#include <set>

#include "common/error.h"
#include "common/parallel.h"
#include "motion/chosen_clips.h"
#include "motion/mirror.h"

namespace mocaplm {

LabelledClip label_clip(const Clip& clip, const Tokenizer& tokenizer,
                        const std::vector<Task>& tasks, std::size_t window_frames) {
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  LabelledClip out;
  out.name = clip.name;
  out.ids = tokenizer.encode(clip).ids;
  while (out.ids.size() < window_frames * per_frame)
    out.ids.push_back(out.ids[out.ids.size() - per_frame]);
  for (const Task& task : tasks) {
    const auto found = clip.labels.find(task.label);
    const auto value = found == clip.labels.end()
                           ? task.values.end()
                           : std::find(task.values.begin(), task.values.end(), found->second);
    out.classes.push_back(
        value == task.values.end() ? -1 : static_cast<int>(value - task.values.begin()));
  }
  return out;
}

std::vector<Task> make_tasks(const Dataset& dataset, const std::vector<std::string>& labels) {
  std::vector<Task> tasks;
  for (const std::string& label : labels) check_label(dataset, label, "labels");
  for (const std::string& label : labels.empty() ? dataset.label_names() : labels) {
    std::set<std::string> values;
    for (const DatasetEntry& entry : dataset.split("train"))
      if (const auto found = entry.labels.find(label); found != entry.labels.end())
        values.insert(found->second);
    if (values.size() >= 2)
      tasks.push_back({label, {values.begin(), values.end()}});
    else if (!labels.empty())
      throw UsageError("label \"" + label + "\" has " + std::to_string(values.size()) +
                       " values in the training split: nothing to tell apart");
  }
  if (tasks.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "no label has two values in the training split");
  return tasks;
}

void add_windows(LabelledSplit& split, std::size_t clip, const Tokenizer& tokenizer,
                 std::size_t window_frames) {
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  const std::size_t last = split.clips[clip].ids.size() / per_frame - window_frames;
  for (std::size_t first = 0; first < last; first += std::max<std::size_t>(window_frames / 2, 1))
    split.windows.push_back({clip, first});
  split.windows.push_back({clip, last});
}

LabelledSplit label_split(const Dataset& dataset, const std::string& split,
                          const Tokenizer& tokenizer, const std::vector<Task>& tasks,
                          std::size_t window_frames, bool mirror_too, int threads) {
  const std::vector<DatasetEntry> entries = dataset.split(split);
  if (entries.empty())
    throw DataError(in_file(dataset.directory.string()), "the split \"" + split + "\" is empty");
  LabelledSplit out;
  out.clips.resize(entries.size() * (mirror_too ? 2 : 1));
  parallel_for(entries.size(), threads, [&](std::size_t i) {
    const Clip clip = load_clip(dataset, entries[i]);
    out.clips[i] = label_clip(clip, tokenizer, tasks, window_frames);
    if (mirror_too)
      out.clips[entries.size() + i] = label_clip(mirror(clip), tokenizer, tasks, window_frames);
  });
  for (std::size_t c = 0; c < out.clips.size(); ++c) add_windows(out, c, tokenizer, window_frames);
  return out;
}

Eigen::MatrixXd window_features(const LabelledSplit& split, const Tokenizer& tokenizer,
                                std::size_t window_frames) {
  const int channels = tokenizer.channels();
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  Eigen::MatrixXd features(static_cast<Eigen::Index>(split.windows.size()),
                           static_cast<Eigen::Index>(window_frames) * channels);
  for (std::size_t w = 0; w < split.windows.size(); ++w) {
    const LabelledClip& clip = split.clips[split.windows[w].clip];
    for (std::size_t t = 0; t < window_frames; ++t)
      for (int c = 0; c < channels; ++c) {
        const std::int32_t id =
            clip.ids[(split.windows[w].first_frame + t) * per_frame + static_cast<std::size_t>(c)];
        features(static_cast<Eigen::Index>(w), static_cast<Eigen::Index>(t) * channels + c) =
            tokenizer.bin_centre(c, id - Tokenizer::kFirstBin);
      }
  }
  return features;
}

std::vector<int> window_classes(const LabelledSplit& split, std::size_t task) {
  std::vector<int> classes;
  for (const WindowPlace& window : split.windows)
    classes.push_back(split.clips[window.clip].classes[task]);
  return classes;
}

}  // namespace mocaplm
