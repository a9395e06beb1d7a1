// An index of a million windows of procedural dances: how fast it is built, and what a query takes
// beside reading the sketches once, which is the least that a search of all windows can cost.
//
//   spectral_bench [--json FILE] [--windows N] [--feature dct] [--reduce 0] [--index FILE]
//
// With --index the file is kept, and used again where it is there: then only queries are measured.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numeric>

#include "bench/result.h"
#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "motion/synth.h"
#include "spectral/search.h"

namespace fs = std::filesystem;

namespace {

using namespace mocaplm;
using bench::Result;
using Clock = std::chrono::steady_clock;

constexpr Eigen::Index kK = 10;
constexpr std::size_t kClipsAtOnce = 8;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

SynthConfig dances(std::int64_t seed) {
  SynthConfig config;
  config.seed = seed;
  config.choreographies = 20;
  config.seconds = 600;
  return config;
}

struct Arguments {
  std::string json, index;
  Eigen::Index windows = 1000000;
  SpectralConfig config;
};

Arguments read_arguments(int argc, char** argv) {
  Arguments arguments;
  arguments.config.feature = "dct";
  arguments.config.stride = 16;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--json") arguments.json = value;
    if (name == "--index") arguments.index = value;
    if (name == "--windows") arguments.windows = std::atoll(value.c_str());
    if (name == "--feature") arguments.config.feature = value;
    if (name == "--reduce") arguments.config.reduce = std::atoll(value.c_str());
  }
  return arguments;
}

std::vector<Series> windows_of(const Clip& clip, const SpectralConfig& config,
                               const std::vector<Eigen::Index>& starts) {
  std::vector<Series> windows;
  for (const Eigen::Index first : starts)
    windows.push_back(window_series(clip, first, config.window, config_joints(config)));
  return windows;
}

std::vector<Eigen::Index> starts_of(const Clip& clip, const SpectralConfig& config,
                                    Eigen::Index most) {
  auto starts = window_starts(clip.frames(), config.window, config.stride);
  if (static_cast<Eigen::Index>(starts.size()) > most) starts.resize(std::size_t(most));
  return starts;
}

// Returns the seconds that it took, without those of making the dances.
double build(const Arguments& arguments, const fs::path& path) {
  const SynthConfig synth = dances(1);
  const std::vector<Dance> plan = plan_dances(synth);
  SynthConfig brief = synth;
  brief.seconds = 20;
  std::vector<Series> sample;
  for (std::size_t i = 0; i < plan.size(); i += plan.size() / 200) {
    const Clip clip = make_dance(plan[i], brief);
    for (Series& window : windows_of(clip, arguments.config, {0, 300, 600, 900}))
      sample.push_back(std::move(window));
  }
  auto start = Clock::now();
  IndexWriter writer(path, arguments.config, sample);
  double spent = seconds_since(start);
  for (std::size_t first = 0; writer.size() < arguments.windows; first += kClipsAtOnce) {
    std::vector<Clip> clips(kClipsAtOnce);
    parallel_for(kClipsAtOnce, 0, [&](std::size_t i) {
      clips[i] = make_dance(plan[(first + i) % plan.size()], synth);
    });
    start = Clock::now();
    std::vector<Series> rows(kClipsAtOnce);
    std::vector<std::vector<Eigen::Index>> starts(kClipsAtOnce);
    parallel_for(kClipsAtOnce, 0, [&](std::size_t i) {
      starts[i] = starts_of(clips[i], arguments.config, 1 << 30);
      rows[i] = writer.features().rows(windows_of(clips[i], arguments.config, starts[i]));
    });
    for (std::size_t i = 0; i < kClipsAtOnce; ++i) {
      const auto left = static_cast<std::size_t>(arguments.windows - writer.size());
      if (left < starts[i].size()) {
        starts[i].resize(left);
        rows[i].conservativeResize(Eigen::Index(left), rows[i].cols());
      }
      writer.add(clips[i].name, starts[i], std::move(rows[i]));
    }
    spent += seconds_since(start);
    std::fprintf(stderr, "%ld windows\n", static_cast<long>(writer.size()));
  }
  start = Clock::now();
  writer.finish("procedural dances");
  return spent + seconds_since(start);
}

// Seconds that all cores take to read `count` floats: the best of several.
double reading_seconds(const float* values, Eigen::Index count) {
  constexpr Eigen::Index kPart = 1 << 19;
  double best = 1e9;
  std::vector<float> sums(static_cast<std::size_t>(count / kPart + 1));
  for (int i = 0; i < 10; ++i) {
    const auto start = Clock::now();
    parallel_for(sums.size(), 0, [&](std::size_t part) {
      const Eigen::Index first = static_cast<Eigen::Index>(part) * kPart;
      sums[part] =
          Eigen::Map<const Eigen::ArrayXf>(values + first, std::min(kPart, count - first)).sum();
    });
    best = std::min(best, seconds_since(start));
  }
  if (std::accumulate(sums.begin(), sums.end(), 0.0f) == 1) std::puts("");  // the sums are needed
  return best;
}

Series queries_of(const SpectralIndex& index) {
  SynthConfig synth = dances(7);  // other dances than the index's
  synth.seconds = 20;
  const std::vector<Dance> plan = plan_dances(synth);
  std::vector<Series> windows;
  for (std::size_t i = 0; i < 40; ++i)
    windows.push_back(windows_of(make_dance(plan[i * 29 % plan.size()], synth), index.config(),
                                 {static_cast<Eigen::Index>(20 * i)})
                          .front());
  return index.features().rows(windows);
}

Result query_result(const SpectralIndex& index, const Series& queries, Measure measure,
                    const std::string& name) {
  std::vector<double> seconds, compared;
  for (Eigen::Index q = 0; q < queries.rows(); ++q) {
    SearchCounts counts;
    nearest(index, queries.row(q).data(), kK, measure, {}, 0, &counts);  // brings its rows in
    const auto start = Clock::now();
    nearest(index, queries.row(q).data(), kK, measure, {}, 0, &counts);
    seconds.push_back(seconds_since(start));
    compared.push_back(static_cast<double>(counts.compared));
  }
  std::sort(seconds.begin(), seconds.end());
  const bool sketched = index.sketch_dimensions() > 0;
  const Eigen::Index width = sketched ? index.sketch_dimensions() : index.dimensions();
  const double reading =
      reading_seconds(sketched ? index.sketch().data() : index.rows().data(), index.size() * width);
  const double middle = bench::median(seconds);
  Result result;
  result.name = "query, " + name + ", " + std::to_string(index.size()) + " windows of " +
                std::to_string(index.dimensions()) + " dimensions";
  result.value = 1 / middle;
  result.unit = "queries/s";
  result.limit = 1 / reading;
  result.limit_name = "memory bandwidth";
  result.ratio = reading / middle;
  result.goal = 0.5;
  std::printf(
      "%s: median %.2f ms, slowest %.2f ms; reading %.2f ms (%.1f GB/s); compared in full: "
      "median %.0f, most %.0f\n",
      result.name.c_str(), 1e3 * middle, 1e3 * seconds.back(), 1e3 * reading,
      4e-9 * static_cast<double>(index.size() * width) / reading, bench::median(compared),
      *std::max_element(compared.begin(), compared.end()));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = read_arguments(argc, argv);
  try {
    const bool keep = !arguments.index.empty();
    const fs::path path = keep ? fs::path(arguments.index)
                               : fs::temp_directory_path() / "mocaplm-spectral-bench.index";
    std::vector<Result> results;
    if (!keep || !fs::exists(path)) {
      double seconds = 0;
      write_file_with(
          path, [&](const fs::path& temporary) { seconds = build(arguments, temporary); },
          Flush::later);
      Result result;
      result.name = "index, " + arguments.config.feature;
      result.value = static_cast<double>(arguments.windows) / seconds;
      result.unit = "windows/s";
      result.goal = 1e6 / 300;  // a million in five minutes
      result.goal_on_value = true;
      results.push_back(result);
      std::printf("built in %.1f s: %.0f windows/s\n", seconds, result.value);
    }
    {
      const SpectralIndex index(path);
      const Series queries = queries_of(index);
      results.push_back(query_result(index, queries, Measure::cosine, "cosine"));
      results.push_back(query_result(index, queries, Measure::euclidean, "Euclidean"));
    }
    if (!keep) fs::remove(path);
    if (!arguments.json.empty())
      bench::write_results(arguments.json, bench::bench_name(argv[0]), results);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return 0;
}
