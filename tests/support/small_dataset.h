// A dataset of random clips in a test's own folder.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "motion/dataset.h"
#include "motion/formats/npz.h"
#include "tokenizer/random_clips.h"

namespace mocaplm {

struct SmallClip {
  std::string name, split;
  Eigen::Index frames;
  Labels labels = {};
  double fps = 20;
  std::uint64_t seed = 0;  // 0: one of its own
};

inline Dataset write_dataset(const std::filesystem::path& folder,
                             const std::vector<SmallClip>& clips) {
  Dataset dataset;
  dataset.directory = folder;
  std::filesystem::create_directories(folder / "clips");
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const SmallClip& one = clips[i];
    DatasetEntry entry;
    entry.name = entry.group = entry.source = one.name;
    entry.file = "clips/" + one.name + ".npz";
    entry.frames = one.frames;
    entry.fps = one.fps;
    entry.labels = one.labels;
    entry.split = one.split;
    write_npz(folder / entry.file,
              random_clip(one.seed > 0 ? one.seed : 1000 + i, one.frames, one.fps, one.name));
    dataset.entries.push_back(entry);
  }
  std::sort(dataset.entries.begin(), dataset.entries.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  save_dataset(dataset);
  return load_dataset(folder);
}

}  // namespace mocaplm
