// Decoding with a key/value cache: tokens/s beside what reading the same bytes (weights, keys and
// values) once a step would allow on this machine, measured in the same run.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "bench/models.h"
#include "bench/result.h"
#include "common/error.h"
#include "common/json.h"
#include "generate/engine.h"

namespace {

using namespace mocaplm;
using bench::median;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Sums `count` words as `streams` sequences side by side: which number of streams the memory likes
// differs from machine to machine.
#if defined(__x86_64__)
__attribute__((target_clones("default", "avx2", "avx512f")))
#endif
std::uint64_t
read_words(const std::uint64_t* words, std::int64_t count, std::int64_t streams) {
  std::uint64_t sums[64] = {};
  const std::int64_t share = count / streams / 64 * 64;
  for (std::int64_t i = 0; i < share; i += 64)
    for (std::int64_t s = 0; s < streams; ++s)
      for (std::int64_t j = 0; j < 64; ++j) sums[j] += words[s * share + i + j];
  std::uint64_t all = 0;
  for (const std::uint64_t sum : sums) all += sum;
  return all;
}

// Seconds that the team takes to read `bytes` of memory, over and over: the median of the best way.
double reading_seconds(std::int64_t bytes, Team& team) {
  Arena arena;
  const std::int64_t words = bytes / 8;
  const auto* memory = reinterpret_cast<const std::uint64_t*>(arena.words(bytes / 4 + 2));
  std::atomic<std::uint64_t> unused{0};
  double best = 1e9;
  for (const std::int64_t streams : {1, 2, 4}) {
    std::vector<double> times;
    for (int i = 0; i < 40; ++i) {
      const auto start = Clock::now();
      team.run([&](int thread) {
        const std::int64_t first = words * thread / team.size(),
                           last = words * (thread + 1) / team.size();
        unused += read_words(memory + first, last - first, streams);
      });
      times.push_back(seconds_since(start));
    }
    best = std::min(best, median(times));
  }
  return best;
}

struct Case {
  char model;
  Precision precision;
  std::int64_t context, batch;
  double goal = 0;  // of the ratio, or
  double goal_value = 0;
};

struct Timed {
  double middle, best;  // seconds a step
  double prompt_rate;   // tokens/s of the prompt before
};

// Steps around `context` cached positions.
Timed timed_steps(Engine& engine, const Case& c) {
  constexpr std::int64_t kSteps = 48;
  const ModelInput prompt = bench_input(engine.description(), c.context - kSteps / 2);
  const ModelInput one = bench_input(engine.description(), 1);
  std::vector<Engine::Feed> feeds;
  const auto start = Clock::now();
  for (std::int64_t s = 0; s < c.batch; ++s) {
    engine.feed_silently({{s, &prompt}});
    feeds.push_back({s, &one});
  }
  const double rate =
      static_cast<double>(c.batch) * static_cast<double>(prompt.size()) / seconds_since(start);
  std::vector<double> times;
  for (std::int64_t i = 0; i < kSteps; ++i) {
    const auto step = Clock::now();
    engine.feed(feeds);
    times.push_back(seconds_since(step));
  }
  return {median(times), *std::min_element(times.begin(), times.end()), rate};
}

Json measure(const Case& c) {
  const StoredModel model = bench_model(c.model);
  Engine engine(model, "bench", {c.precision, 0, c.batch});
  const auto [seconds, best, prompt_rate] = timed_steps(engine, c);
  Team team(0);
  const std::int64_t bytes = engine.bytes_a_step(c.context);
  const double limit_seconds = reading_seconds(bytes, team);
  const auto batch = static_cast<double>(c.batch);
  const std::string name = std::string(1, c.model) + " " + to_string(c.precision) + ", context " +
                           std::to_string(c.context) + ", batch " + std::to_string(c.batch);
  Json row = {{"name", name},
              {"value", batch / seconds},
              {"unit", "tokens/s"},
              {"limit", batch / limit_seconds},
              {"limit_name", "reading the weights and the cache once a step"},
              {"ratio", limit_seconds / seconds},
              {"best_step", batch / best},
              {"read_gb_per_second", 1e-9 * static_cast<double>(bytes) / limit_seconds},
              {"prompt_tokens_per_second", prompt_rate}};
  if (c.goal > 0) row["goal"] = c.goal;
  if (c.goal_value > 0) {
    row["goal"] = c.goal_value;
    row["goal_on"] = "value";
  }
  std::printf(
      "%-34s %7.0f tokens/s (best step %7.0f), limit %7.0f at %3.0f GB/s, ratio %.2f, prompt "
      "%6.0f\n",
      name.c_str(), batch / seconds, batch / best, batch / limit_seconds,
      1e-9 * static_cast<double>(bytes) / limit_seconds, limit_seconds / seconds, prompt_rate);
  std::fflush(stdout);
  return row;
}

std::vector<Case> cases() {
  using P = Precision;
  return {{'A', P::f32, 512, 1},
          {'A', P::bf16, 512, 1, 0.6},
          {'A', P::int8, 512, 1, 0.5},
          {'A', P::bf16, 1000, 1},
          {'A', P::int8, 1000, 1},
          {'A', P::bf16, 512, 16},
          {'A', P::int8, 512, 16, 0, 2500},
          {'B', P::f32, 512, 1},
          {'B', P::bf16, 512, 1, 0, 15000},
          {'B', P::int8, 512, 1, 0, 15000}};
}

}  // namespace

// decode_bench [--json FILE]
int main(int argc, char** argv) {
  try {
    Json results = Json::array();
    for (const Case& c : cases()) results.push_back(measure(c));
    if (argc == 3 && std::strcmp(argv[1], "--json") == 0)
      save_json(
          argv[2],
          {{"bench", "decode"}, {"kernels", to_string(best_kernel_level())}, {"results", results}});
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "decode_bench: " << error.what() << "\n";
    return 1;
  }
}
