// Clips to tokens on one core, in frames of the token stream (20 a second, 13 joints, 360 bins) a
// second, with the resampling that leads to them: from 60 frames a second, where every third is
// taken, from 30, where every second one lies between two, and from 50, where three of four do.
// Beside it: copying the clip, the least that a pass over it costs.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "motion/resample.h"
#include "motion/synth.h"
#include "tokenizer/measure.h"

namespace {

using namespace mocaplm;

// Two minutes of a dance.
Clip dance(double fps) {
  SynthConfig config;
  config.seconds = 120;
  config.fps = fps;
  return make_dance(plan_dances(config).front(), config);
}

// Frames a second of nothing but copying them, the least that resampling to another clip can cost.
double copy_rate(const Clip& clip) {
  double best = 0;
  for (int i = 0; i < 20; ++i) {
    const auto start = std::chrono::steady_clock::now();
    Clip copy = clip;
    benchmark::DoNotOptimize(copy);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    best = std::max(best, static_cast<double>(clip.frames()) / seconds.count());
  }
  return best;
}

void report(benchmark::State& state, const Clip& clip, std::int64_t frames) {
  using benchmark::Counter;
  const auto count = static_cast<double>(frames);
  state.counters["frames/s"] = Counter(count, Counter::kIsIterationInvariantRate);
  state.counters["of copying the frames"] =
      Counter(count / copy_rate(clip), Counter::kIsIterationInvariantRate);
  state.counters["goal of value"] = 300000;
}

std::string rate_text(const benchmark::State& state) {
  return "from " + std::to_string(state.range(0)) + " frames/s";
}

void encode(benchmark::State& state, const char* binning) {
  const Clip clip = dance(static_cast<double>(state.range(0)));
  TokenizerConfig config;
  config.binning = binning;
  const Tokenizer tokenizer = Tokenizer::fit(config, {clip});
  std::int64_t frames = 0;
  for (auto unused : state) {
    const TokenStream stream = tokenizer.encode(clip);
    frames = stream.frame.back() + 1;
  }
  report(state, clip, frames);
  state.SetLabel("clip to tokens, " +
                 (config.binning == "uniform" ? "" : config.binning + " bins, ") +
                 rate_text(state));
}

// What `mocaplm tokenize` does with a clip: it also decodes the tokens and measures what was lost.
void encode_and_measure_loss(benchmark::State& state) {
  const Clip clip = dance(static_cast<double>(state.range(0)));
  const Tokenizer tokenizer = Tokenizer::fit({}, {clip});
  std::int64_t frames = 0;
  for (auto unused : state) {
    TokenizerLoss loss;
    encode_and_measure(tokenizer, clip, loss);
    frames = loss.frames;
  }
  report(state, clip, frames);
  state.SetLabel("clip to tokens, decoded and measured, " + rate_text(state));
}

}  // namespace

BENCHMARK_CAPTURE(encode, uniform, "uniform")
    ->Arg(60)
    ->Arg(30)
    ->Arg(50)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode, quantile, "quantile")->Arg(60)->Unit(benchmark::kMillisecond);
BENCHMARK(encode_and_measure_loss)->Arg(60)->Arg(30)->Arg(50)->Unit(benchmark::kMillisecond);
