// An index of windows of procedural dances: how fast it is built, what a query takes beside reading
// all coarse sketches once, which is the least that a search of all windows can cost, and whether
// the search finds what comparing every row in double precision finds.
//
//   spectral_bench [--json FILE] [--windows 100000] [--feature dct] [--reduce 0] [--index FILE]
//
// As it is it takes half a gigabyte of disk for a minute or two; a million windows take 5 GB. With
// --index the file is kept, and used again where it is there: then only queries are measured.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>

#include "bench/result.h"
#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "common/text.h"
#include "motion/synth.h"
#include "spectral/index_layout.h"
#include "spectral/search.h"

namespace fs = std::filesystem;

namespace {

using namespace mocaplm;
using bench::Result;
using Clock = std::chrono::steady_clock;

constexpr Eigen::Index kK = 10;
constexpr std::size_t kClipsAtOnce = 8;
constexpr Eigen::Index kRowsAtOnce = 2048;  // compared in double precision

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
  Eigen::Index windows = 100000;
  SpectralConfig config;
};

Arguments read_arguments(int argc, char** argv) {
  Arguments arguments;
  arguments.config.feature = "dct";
  arguments.config.stride = 16;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i], value = i + 1 < argc ? argv[i + 1] : "";
    if (value.empty()) throw UsageError(name + " needs a value");
    if (name == "--json")
      arguments.json = value;
    else if (name == "--index")
      arguments.index = value;
    else if (name == "--windows")
      arguments.windows = std::atoll(value.c_str());
    else if (name == "--feature")
      arguments.config.feature = value;
    else if (name == "--reduce")
      arguments.config.reduce = std::atoll(value.c_str());
    else
      throw UsageError("there is no option " + name);
  }
  if (arguments.windows < 100) throw UsageError("--windows: expected 100 or more");
  return arguments;
}

// Throws DataError where the disk has no room for the index.
void check_room(const Arguments& arguments, const fs::path& path) {
  const FeatureMaker features(arguments.config, 72);
  const Eigen::Index d = features.dimensions();
  const IndexLayout layout = index_layout(arguments.config, features.raw_dimensions(),
                                          arguments.windows, d, sketch_size(d));
  const double needed = 1.05 * static_cast<double>(layout.json);
  const auto room = static_cast<double>(fs::space(fs::absolute(path).parent_path()).available);
  if (needed > room)
    throw DataError(in_file(path.string()), "needs " + format_fixed(1e-9 * needed, 1) +
                                                " GB, the disk has " +
                                                format_fixed(1e-9 * room, 1) +
                                                ": give fewer --windows, --reduce or --index");
}

std::vector<Series> windows_of(const Clip& clip, const SpectralConfig& config,
                               const std::vector<Eigen::Index>& starts) {
  std::vector<Series> windows;
  for (const Eigen::Index first : starts)
    windows.push_back(window_series(clip, first, config.window, config_joints(config)));
  return windows;
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
      starts[i] =
          window_starts(clips[i].frames(), arguments.config.window, arguments.config.stride);
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

// What ranks `count` rows from `first` on, in double precision: the cosine, or the distance's
// square, negative. (count, queries)
Eigen::MatrixXd scores_of(const SpectralIndex& index, Eigen::Index first, Eigen::Index count,
                          const Eigen::MatrixXd& units, const Eigen::VectorXd& lengths,
                          Measure measure) {
  const Eigen::MatrixXd rows = index.rows().middleRows(first, count).cast<double>();
  Eigen::MatrixXd scores = rows * units.transpose();
  if (measure == Measure::cosine) return scores;
  // Unit vectors in single precision are of length 1 to seven digits only.
  const Eigen::ArrayXd own = index.lengths().segment(first, count).cast<double>().array();
  const Eigen::ArrayXd squares = own.square() * rows.rowwise().squaredNorm().array();
  for (Eigen::Index q = 0; q < scores.cols(); ++q) {
    const double square = lengths[q] * lengths[q] * units.row(q).squaredNorm();
    scores.col(q).array() = 2 * lengths[q] * own * scores.col(q).array() - squares - square;
  }
  return scores;
}

void greatest_first(double* values, Eigen::Index count) {
  std::partial_sort(values, values + std::min(kK, count), values + count, std::greater<>());
}

// The scores of each query's k best rows, best first, by comparing all of them: (k, queries).
Eigen::MatrixXd best_of_all(const SpectralIndex& index, const Series& queries, Measure measure) {
  Series unit_rows = queries;
  const Eigen::VectorXd lengths = normalise_rows(unit_rows).cast<double>();
  const Eigen::MatrixXd units = unit_rows.cast<double>();
  const auto blocks = static_cast<std::size_t>((index.size() + kRowsAtOnce - 1) / kRowsAtOnce);
  std::vector<Eigen::MatrixXd> parts(blocks);
  parallel_for(blocks, 0, [&](std::size_t b) {
    const Eigen::Index first = static_cast<Eigen::Index>(b) * kRowsAtOnce;
    const Eigen::Index count = std::min(kRowsAtOnce, index.size() - first);
    Eigen::MatrixXd scores = scores_of(index, first, count, units, lengths, measure);
    for (Eigen::Index q = 0; q < scores.cols(); ++q) greatest_first(scores.col(q).data(), count);
    parts[b] = scores.topRows(std::min(kK, count));
  });
  Eigen::MatrixXd found(kK, queries.rows());
  for (Eigen::Index q = 0; q < queries.rows(); ++q) {
    std::vector<double> all;
    for (const Eigen::MatrixXd& part : parts)
      all.insert(all.end(), part.col(q).data(), part.col(q).data() + part.rows());
    greatest_first(all.data(), static_cast<Eigen::Index>(all.size()));
    found.col(q) = Eigen::Map<const Eigen::VectorXd>(all.data(), kK);
  }
  return found;
}

// The share of the true neighbours that the search finds; of equally near ones any will do.
Result recall_result(const SpectralIndex& index, const Series& queries, Measure measure,
                     const std::string& name) {
  const Eigen::MatrixXd best = best_of_all(index, queries, measure);
  double right = 0;
  for (Eigen::Index q = 0; q < queries.rows(); ++q) {
    const auto found = nearest(index, queries.row(q).data(), kK, measure);
    const double length = queries.row(q).cast<double>().squaredNorm();
    const double rounding = 1e-9 * (measure == Measure::cosine ? 1 : length);
    for (Eigen::Index i = 0; i < kK; ++i) {
      const Neighbour& one = found[static_cast<std::size_t>(i)];
      const double score =
          measure == Measure::cosine ? one.similarity : -one.distance * one.distance;
      right += std::abs(score - best(i, q)) <= rounding;
    }
  }
  Result result;
  result.name = "recall at 10, " + name + ", " + std::to_string(index.size()) + " windows";
  result.value = right / static_cast<double>(queries.rows() * kK);
  result.unit = "share";
  result.goal = 1;
  result.goal_on_value = true;
  std::printf("%s: %.4f\n", result.name.c_str(), result.value);
  return result;
}

Result query_result(const SpectralIndex& index, const Series& queries, Measure measure,
                    const std::string& name) {
  std::vector<double> seconds, compared, sketches;
  for (Eigen::Index q = 0; q < queries.rows(); ++q) {
    SearchCounts counts;
    nearest(index, queries.row(q).data(), kK, measure, {}, 0, &counts);  // brings its rows in
    const auto start = Clock::now();
    nearest(index, queries.row(q).data(), kK, measure, {}, 0, &counts);
    seconds.push_back(seconds_since(start));
    compared.push_back(static_cast<double>(counts.compared));
    sketches.push_back(static_cast<double>(counts.sketched));
  }
  std::sort(seconds.begin(), seconds.end());
  const bool sketched = index.sketch_dimensions() > 0;
  const Eigen::Index width = sketched ? kCoarse : index.dimensions();
  const double reading =
      reading_seconds(sketched ? index.coarse().data() : index.rows().data(), index.size() * width);
  const double middle = bench::median(seconds);
  Result result;
  result.name = "query, " + name + ", " + std::to_string(index.size()) + " windows of " +
                std::to_string(index.dimensions()) + " dimensions";
  result.value = 1 / middle;
  result.unit = "queries/s";
  result.limit = 1 / reading;
  result.limit_name = sketched ? "reading all coarse sketches" : "reading all rows";
  result.ratio = reading / middle;
  result.goal = 0.5;
  std::printf(
      "%s: median %.2f ms, slowest %.2f ms; reading %.2f ms (%.1f GB/s); median of %.0f rows past "
      "the coarse sketches, %.0f compared in full (most: %.0f)\n",
      result.name.c_str(), 1e3 * middle, 1e3 * seconds.back(), 1e3 * reading,
      4e-9 * static_cast<double>(index.size() * width) / reading, bench::median(sketches),
      bench::median(compared), *std::max_element(compared.begin(), compared.end()));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments arguments = read_arguments(argc, argv);
    const bool keep = !arguments.index.empty();
    const fs::path path = keep ? fs::path(arguments.index)
                               : fs::temp_directory_path() / "mocaplm-spectral-bench.index";
    std::vector<Result> results;
    if (!keep || !fs::exists(path)) {
      check_room(arguments, path);
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
      for (const auto& [measure, name] :
           {std::pair(Measure::cosine, "cosine"), std::pair(Measure::euclidean, "Euclidean")}) {
        results.push_back(query_result(index, queries, measure, name));
        results.push_back(recall_result(index, queries, measure, name));
      }
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
