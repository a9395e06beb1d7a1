#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/random.h"
#include "common/text.h"
#include "motion/skeleton.h"
#include "numeric/leading_components.h"
#include "spectral/index.h"
#include "spectral/index_layout.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// Windows that features and sketch learn from: some of some clips.
constexpr std::size_t kSampleClips = 512, kSampleWindows = 8;
// Clips whose rows are made at once.
constexpr std::size_t kBatch = 32;

}  // namespace

struct IndexWriter::State {
  State(const fs::path& file, const SpectralConfig& settings)
      : path(file),
        config(settings),
        features(settings, 3 * static_cast<Eigen::Index>(config_joints(settings).size())),
        out(file, std::ios::binary) {}

  void check() const {
    if (!out)
      throw DataError(in_file(path.string()),
                      std::string("cannot be written: ") + std::strerror(errno));
  }
  void write(const void* data, std::size_t bytes) {
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  }
  template <class Matrix>
  void write(const Matrix& matrix) {
    write(matrix.data(), sizeof(float) * static_cast<std::size_t>(matrix.size()));
  }

  fs::path path;
  SpectralConfig config;
  FeatureMaker features;
  Eigen::MatrixXf basis;  // of the sketch
  std::ofstream out;
  std::vector<float> sketch, coarse, lengths;
  std::vector<MotionWindow> windows;
  std::vector<std::string> clips;
  std::int64_t too_short = 0;
};

IndexWriter::IndexWriter(const fs::path& path, const SpectralConfig& config,
                         const std::vector<Series>& sample)
    : state_(std::make_unique<State>(path, config)) {
  State& state = *state_;
  if (state.features.needs_fit()) state.features.fit(sample);
  const Eigen::Index d = state.features.dimensions(), s = sketch_size(d);
  if (s > 0) {
    Series rows = state.features.rows(sample);
    normalise_rows(rows);
    state.basis = leading_components(Eigen::MatrixXf(rows), s - 1, 1, false).basis;
  }
  const std::vector<char> head(kIndexRows, 0);
  state.write(head.data(), head.size());
  state.check();
}

IndexWriter::~IndexWriter() = default;

const FeatureMaker& IndexWriter::features() const {
  return state_->features;
}

Eigen::Index IndexWriter::size() const {
  return static_cast<Eigen::Index>(state_->windows.size());
}

void IndexWriter::add(const std::string& clip, const std::vector<Eigen::Index>& starts,
                      Series rows) {
  State& state = *state_;
  const auto number = static_cast<std::uint32_t>(state.clips.size());
  state.clips.push_back(clip);
  if (starts.empty()) ++state.too_short;
  if (!rows.allFinite()) throw DataError(in_file(clip), "its spectral features are not finite");
  const Eigen::VectorXf lengths = normalise_rows(rows);
  state.lengths.insert(state.lengths.end(), lengths.data(), lengths.data() + lengths.size());
  for (const Eigen::Index first : starts)
    state.windows.push_back({number, static_cast<std::uint32_t>(first)});
  if (state.basis.size() > 0) {
    const Series sketch = make_sketch(rows, state.basis);
    const Series coarse = make_coarse(sketch);
    state.sketch.insert(state.sketch.end(), sketch.data(), sketch.data() + sketch.size());
    state.coarse.insert(state.coarse.end(), coarse.data(), coarse.data() + coarse.size());
  }
  state.write(rows);
  state.check();
}

void IndexWriter::finish(const std::string& fingerprint) {
  State& state = *state_;
  state.write(state.sketch.data(), sizeof(float) * state.sketch.size());
  state.write(state.coarse.data(), sizeof(float) * state.coarse.size());
  state.write(state.lengths.data(), sizeof(float) * state.lengths.size());
  state.write(state.windows.data(), sizeof(MotionWindow) * state.windows.size());
  const FeatureMaker::Learned& learned = state.features.learned();
  state.write(learned.time_mean);
  state.write(learned.time_basis);
  state.write(learned.reduce_mean);
  state.write(learned.reduce_basis);
  state.write(state.basis);
  const Eigen::Index d = state.features.dimensions();
  const Json json = {{"settings", settings_json(state.config)},
                     {"windows", state.windows.size()},
                     {"dimensions", d},
                     {"sketch", sketch_size(d)},
                     {"clips", state.clips},
                     {"too_short", state.too_short},
                     {"dataset", fingerprint}};
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::uint64_t head[2] = {static_cast<std::uint64_t>(state.out.tellp()), text.size()};
  state.write(text.data(), text.size());
  state.out.seekp(0);
  state.write(kIndexMagic, sizeof kIndexMagic);
  state.write(head, sizeof head);
  state.out.close();
  state.check();
}

std::string dataset_fingerprint(const Dataset& dataset) {
  std::uint64_t hash = 0;
  for (const DatasetEntry& entry : dataset.entries) {
    const fs::path file = dataset.directory / entry.file;
    std::error_code error;
    const auto bytes = fs::file_size(file, error);
    if (error) throw DataError(in_file(file.string()), "cannot be read: " + error.message());
    const auto written = fs::last_write_time(file, error).time_since_epoch().count();
    hash = stable_hash(entry.name + "|" + entry.file + "|" + std::to_string(entry.frames) + "|" +
                           format_number(entry.fps) + "|" + std::to_string(bytes) + "|" +
                           std::to_string(written),
                       hash);
  }
  return hex(hash);
}

std::string config_fingerprint(const SpectralConfig& config) {
  return hex(stable_hash(kIndexMagic + settings_json(config).dump()));
}

namespace {

std::vector<Series> sample_windows(const Dataset& dataset, const SpectralConfig& config,
                                   const std::vector<int>& joints, std::int64_t threads) {
  const std::size_t clips = dataset.entries.size();
  const std::size_t every = (clips + kSampleClips - 1) / std::max<std::size_t>(kSampleClips, 1);
  const std::size_t taken = every > 0 ? (clips + every - 1) / every : 0;
  std::vector<std::vector<Series>> parts(taken);
  parallel_for(taken, threads, [&](std::size_t i) {
    const Clip clip = at_window_rate(load_clip(dataset, dataset.entries[i * every]), config);
    const auto starts = window_starts(clip.frames(), config.window, config.stride);
    const std::size_t step = starts.size() / kSampleWindows + 1;
    for (std::size_t w = 0; w < starts.size(); w += step)
      parts[i].push_back(window_series(clip, starts[w], config.window, joints));
  });
  std::vector<Series> sample;
  for (std::vector<Series>& part : parts)
    std::move(part.begin(), part.end(), std::back_inserter(sample));
  return sample;
}

struct ClipRows {
  std::vector<Eigen::Index> starts;
  Series rows;
};

ClipRows rows_of_clip(const Dataset& dataset, const DatasetEntry& entry,
                      const SpectralConfig& config, const std::vector<int>& joints,
                      const FeatureMaker& features) {
  const Clip clip = at_window_rate(load_clip(dataset, entry), config);
  ClipRows out;
  out.starts = window_starts(clip.frames(), config.window, config.stride);
  std::vector<Series> windows;
  for (const Eigen::Index first : out.starts)
    windows.push_back(window_series(clip, first, config.window, joints));
  out.rows = features.rows(windows);
  return out;
}

}  // namespace

void build_index(const Dataset& dataset, const SpectralConfig& config, const fs::path& path,
                 std::int64_t threads) {
  check_config(config);
  const std::vector<int> joints = config_joints(config);
  const std::string fingerprint = dataset_fingerprint(dataset);
  std::vector<Series> sample = sample_windows(dataset, config, joints, threads);
  if (sample.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "no clip is as long as a window (" + std::to_string(config.window) +
                        " frames at " + format_number(config.fps) +
                        " per second): give a smaller --window, or --short-clips hold");
  const auto fill = [&](const fs::path& temporary) {
    IndexWriter writer(temporary, config, sample);
    sample.clear();
    Progress progress("index", dataset.entries.size(), "clips");
    for (std::size_t first = 0; first < dataset.entries.size(); first += kBatch) {
      std::vector<ClipRows> batch(std::min(kBatch, dataset.entries.size() - first));
      parallel_for(batch.size(), threads, [&](std::size_t i) {
        batch[i] =
            rows_of_clip(dataset, dataset.entries[first + i], config, joints, writer.features());
      });
      for (std::size_t i = 0; i < batch.size(); ++i)
        writer.add(dataset.entries[first + i].name, batch[i].starts, std::move(batch[i].rows));
      progress.update(first + batch.size(), std::to_string(writer.size()) + " windows");
    }
    writer.finish(fingerprint);
    progress.finish(std::to_string(writer.size()) + " windows");
  };
  write_file_with(path, fill, Flush::later);
}

SpectralIndex index_of(const Dataset& dataset, const SpectralConfig& config, const fs::path& folder,
                       std::int64_t threads, std::string* note) {
  check_config(config);
  const fs::path file = (folder.empty() ? dataset.directory : folder) /
                        ("query-" + config.feature + "-" + config_fingerprint(config) + ".index");
  const auto tell = [&](const std::string& text) {
    if (note != nullptr) *note = file.string() + ": " + text;
  };
  const bool there = fs::exists(file);
  if (there) {
    SpectralIndex index(file);
    const bool same_settings = settings_json(index.config()) == settings_json(config);
    if (same_settings && index.fingerprint() == dataset_fingerprint(dataset)) {
      tell("the index, kept from before");
      return index;
    }
    if (!folder.empty())
      throw DataError(
          in_file(file.string()),
          std::string("is an index of ") +
              (same_settings ? "another dataset, or the dataset has changed" : "other settings") +
              ": give another --keep, or remove the file to have it built again");
  }
  try {
    check_writable(file);
  } catch (const DataError& error) {
    throw DataError(in_file(file.string()), "the index cannot be kept here: give --keep FOLDER (" +
                                                std::string(error.what()) + ")");
  }
  build_index(dataset, config, file, threads);
  tell(there ? "the dataset has changed, the index was built again" : "the index, built now");
  return SpectralIndex(file);
}

}  // namespace mocaplm
