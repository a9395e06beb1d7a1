// Reading BVH on one core: megabytes of text a second, of procedural dances written as BVH in three
// manners. Beside it, over the same text and in the same run, the C library's strtod as a peer for
// the numbers, and reading the file and counting its lines, which no reader can be faster than.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/formats/retarget.h"
#include "motion/synth.h"

namespace {

using namespace mocaplm;

// A minute of a dance: 3,600 frames, about 3 MB of text.
const std::string& dance_text() {
  static const std::string text = [] {
    SynthConfig config;
    config.seconds = 60;
    return bvh_text(make_dance(plan_dances(config).front(), config));
  }();
  return text;
}

void append(std::string& text, const char* format, double value) {
  char number[64];
  text.append(number,
              static_cast<std::size_t>(std::snprintf(number, sizeof number, format, value)));
}

// The same dance with other channels or numbers; `six`: every joint has six channels.
std::string rewritten(const char* format, bool six) {
  const Bvh bvh = parse_bvh(dance_text(), "dance.bvh");
  const std::string& full = dance_text();
  std::string out = full.substr(0, full.find('\n', full.find("Frame Time")) + 1);
  const std::string three = "CHANNELS 3 ", all = "CHANNELS 6 Xposition Yposition Zposition ";
  for (std::size_t at = 0; six && (at = out.find(three, at)) != std::string::npos;)
    out.replace(at, three.size(), all);
  for (Eigen::Index t = 0; t < bvh.frames(); ++t) {
    for (const BvhJoint& joint : bvh.joints) {
      if (six && joint.channels.size() == 3)
        for (int axis = 0; axis < 3; ++axis) append(out += ' ', format, joint.offset[axis]);
      for (std::size_t c = 0; c < joint.channels.size(); ++c)
        append(out += ' ', format, bvh.values(t, joint.first_channel + static_cast<int>(c)));
    }
    out += '\n';
  }
  return out;
}

enum Manner { own, recorded, shortest };

const std::string& text_of(Manner manner) {
  // Six channels a joint and six decimals, as the Bandai-Namco recordings are written.
  static const std::string recorded_text = rewritten("%.6f", true);
  // Six significant digits, and joints that stand still are a "0": there a frame has a third of the
  // text, and its kinematics count more than its numbers.
  static const std::string short_text = rewritten("%g", false);
  return manner == own ? dance_text() : manner == recorded ? recorded_text : short_text;
}

// The file that the text is in, in the page cache; removed at the end.
class TextFile {
 public:
  explicit TextFile(const std::string& text) : path_(folder_ / "dance.bvh") {
    write_file(path_, text);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_;
};

const TextFile& file_of(Manner manner) {
  static const TextFile files[] = {TextFile(text_of(own)), TextFile(text_of(recorded)),
                                   TextFile(text_of(shortest))};
  return files[manner];
}

// Bytes a second of `work` on `bytes`: the best of several.
double rate_of(std::size_t bytes, const std::function<void()>& work) {
  double best = 0;
  for (int i = 0; i < 8; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    best = std::max(best, static_cast<double>(bytes) / seconds.count());
  }
  return best;
}

double strtod_rate(const std::string& text) {
  const char* motion = std::strchr(std::strstr(text.c_str(), "Frame Time"), '\n');
  const auto bytes = static_cast<std::size_t>(text.c_str() + text.size() - motion);
  return rate_of(bytes, [&] {
    double sum = 0;
    char* end = nullptr;
    for (const char* at = motion;; at = end) {
      const double value = std::strtod(at, &end);
      if (end == at) break;
      sum += value;
    }
    benchmark::DoNotOptimize(sum);
  });
}

double line_scan_rate(const TextFile& file) {
  return rate_of(std::filesystem::file_size(file.path()), [&] {
    const std::string text = read_file(file.path(), std::uintmax_t{1} << 30);
    std::size_t lines = 0;
    const char *at = text.data(), *const end = at + text.size();
    while ((at = static_cast<const char*>(
                std::memchr(at, '\n', static_cast<std::size_t>(end - at)))) != nullptr) {
      ++lines;
      ++at;
    }
    benchmark::DoNotOptimize(lines);
  });
}

void report(benchmark::State& state, std::size_t bytes, const std::string& limit, double rate) {
  using benchmark::Counter;
  const auto count = static_cast<double>(bytes);
  state.counters["MB/s"] = Counter(count * 1e-6, Counter::kIsIterationInvariantRate);
  state.counters["of " + limit] = Counter(count / rate, Counter::kIsIterationInvariantRate);
}

Manner manner_of(const benchmark::State& state) {
  return static_cast<Manner>(state.range(0));
}

void label(benchmark::State& state, const std::string& what) {
  const char* const manners[] = {"as we write it", "as recordings", "short numbers"};
  state.SetLabel(what + ", " + manners[state.range(0)]);
}

// Text in memory to numbers.
void parse(benchmark::State& state) {
  const std::string& text = text_of(manner_of(state));
  const double peer = strtod_rate(text);
  for (auto unused : state) benchmark::DoNotOptimize(parse_bvh(text, "dance.bvh"));
  report(state, text.size(), "strtod", peer);
  label(state, "BVH text to numbers");
}

// What `mocaplm import` does for a file before it writes the clip: reads it from the page cache,
// parses it and brings it to SMPL's skeleton, measuring the limbs' directions.
void read_clip(benchmark::State& state) {
  const TextFile& file = file_of(manner_of(state));
  const double limit = line_scan_rate(file);
  for (auto unused : state) {
    RetargetReport limbs;
    benchmark::DoNotOptimize(read_bvh_clip(file.path(), {}, &limbs));
  }
  report(state, std::filesystem::file_size(file.path()), "reading and counting lines", limit);
  if (manner_of(state) != shortest) state.counters["goal of value"] = 150;
  label(state, "BVH file to clip");
}

}  // namespace

BENCHMARK(parse)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(read_clip)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
