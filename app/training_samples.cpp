#include "app/training_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "app/training_page.h"
#include "common/error.h"
#include "generate/generator.h"
#include "motion/formats/formats.h"
#include "viewer/page.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr double kShare = 0.01;  // of the time of training that samples may take

// The first validation clip that is long enough, else the longest; its first `seconds`.
Clip choose_clip(const Dataset& dataset, double seconds) {
  const std::vector<DatasetEntry> entries = dataset.split("validation");
  if (entries.empty()) throw DataError(in_file(dataset.directory), "there is no validation clip");
  auto chosen = std::find_if(entries.begin(), entries.end(),
                             [&](const DatasetEntry& entry) { return entry.seconds() >= seconds; });
  if (chosen == entries.end())
    chosen = std::max_element(
        entries.begin(), entries.end(),
        [](const DatasetEntry& a, const DatasetEntry& b) { return a.seconds() < b.seconds(); });
  const Clip clip = load_clip(dataset, *chosen);
  const auto frames = static_cast<Eigen::Index>(std::llround(seconds * clip.fps));
  return slice(clip, 0, std::clamp<Eigen::Index>(frames, 1, clip.frames()));
}

}  // namespace

TrainingSamples::TrainingSamples(fs::path run, const SampleConfig& config, int threads)
    : run_(std::move(run)), seconds_(config.sample_seconds), threads_(threads) {}

bool TrainingSamples::due(const Validated& now) const {
  const double passed = std::chrono::duration<double>(Clock::now() - start_).count();
  return seconds_ > 0 && (first_ || now.last || spent_ < kShare * passed);
}

void TrainingSamples::look(const Validated& now) {
  if (!due(now)) return;
  first_ = false;
  const Clock::time_point begin = Clock::now();
  try {
    sample(now);
  } catch (const std::exception& error) {
    seconds_ = 0;
    std::fprintf(stderr, "note: no samples are made while training: %s\n", error.what());
  }
  spent_ += std::chrono::duration<double>(Clock::now() - begin).count();
}

void TrainingSamples::sample(const Validated& now) {
  const StoredModel model = now.model();
  if (model.description.masked()) {
    seconds_ = 0;
    return;
  }
  const fs::path folder = run_ / "samples";
  if (clip_.frames() == 0) {
    clip_ = choose_clip(now.dataset, kSamplePrompt + seconds_);
    fs::create_directories(folder);
    write_clip(folder / "clip.npz", clip_);
  }
  Generator generator(model, run_.string(), {Precision::bf16, threads_, 1});
  GenerateRequest request;
  request.prompt = clip_;
  request.prompt_seconds = kSamplePrompt;
  request.seconds = seconds_;
  const GenerateResult made = generator.generate(request);
  write_clip(folder / ("step-" + std::to_string(now.step) + ".npz"), made.clip);
  write_page(run_ / "training.html", training_page(run_));
}

TrainingSampleFiles training_samples(const fs::path& run) {
  TrainingSampleFiles found;
  const fs::path folder = run / "samples";
  if (!fs::exists(folder / "clip.npz")) return found;
  found.clip = folder / "clip.npz";
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    long long step = 0;
    int whole = 0;
    if (std::sscanf(name.c_str(), "step-%lld.npz%n", &step, &whole) == 1 &&
        static_cast<std::size_t>(whole) == name.size())
      found.samples.emplace_back(step, entry.path());
  }
  std::sort(found.samples.begin(), found.samples.end());
  return found;
}

}  // namespace mocaplm
