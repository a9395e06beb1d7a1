// Generating: frames a second of "architecture": "frames" beside those of "flat" with as many
// parameters, from the same command line's point of view: a frame is 14 joints of 3 channels.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "bench/result.h"
#include "common/error.h"
#include "common/json.h"
#include "generate/decoder.h"
#include "generate/kernels/kernels.h"
#include "model/transformer/weights.h"

namespace {

using namespace mocaplm;
using Clock = std::chrono::steady_clock;

ModelDescription description(const std::string& architecture) {
  ModelDescription d;
  d.config.architecture = architecture;
  d.config.dropout = 0;
  d.shape = {4 + 360, 4, 360, 42};
  d.tokenizer_fingerprint = "none";
  return d;
}

ModelDescription frames_model(std::int64_t wide, std::int64_t narrow) {
  ModelDescription d = description("frames");
  d.config.n_embd = wide;
  d.config.block_size = 256;
  d.config.decoder_embd = narrow;
  return d;
}

// The flat model of four layers whose parameters are nearest in number.
ModelDescription flat_model(double parameters) {
  ModelDescription d = description("flat");
  d.config.block_size = 1024;
  const auto distance = [&](std::int64_t width) {
    d.config.n_embd = width;
    return std::abs(parameter_count(d) - parameters);
  };
  std::int64_t best = 32;
  for (std::int64_t width = 32; width <= 1024; width += 32)
    if (distance(width) < distance(best)) best = width;
  d.config.n_embd = best;
  return d;
}

StoredModel random_model(const ModelDescription& d) {
  at::manual_seed(1);
  StoredModel stored;
  stored.description = d;
  stored.tensors = export_weights(*make_language_model(d));
  return stored;
}

// The likeliest bin each time, behind a second of motion that stands still.
double frames_a_second(const ModelDescription& d, Precision precision) {
  constexpr int kPrompt = 20, kFrames = 60;
  const std::unique_ptr<Decoder> decoder =
      make_decoder(random_model(d), "bench", {precision, 0, 1});
  decoder->begin(0, {2}, {});
  const auto separator = static_cast<std::int32_t>(d.shape.first_bin) - 1;
  for (int frame = 0; frame < kPrompt; ++frame) {
    for (std::int64_t c = 0; c < d.shape.channels; ++c) decoder->push(0, separator + 180);
    decoder->push(0, separator);
  }
  std::vector<double> times;  // the first frame's holds the prompt; the median does not see it
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto start = Clock::now();
    for (std::int64_t c = 0; c < d.shape.channels; ++c) {
      const auto& logits = decoder->logits({0})[0];
      const auto bins = logits.begin() + d.shape.first_bin;
      decoder->push(0, static_cast<std::int32_t>(std::max_element(bins, bins + d.shape.bins) -
                                                 logits.begin()));
    }
    decoder->push(0, separator);
    times.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  return 1 / bench::median(times);
}

Json measure(std::int64_t wide, std::int64_t narrow, Precision precision) {
  const ModelDescription frames = frames_model(wide, narrow),
                         flat = flat_model(parameter_count(frames));
  const double fast = frames_a_second(frames, precision), slow = frames_a_second(flat, precision);
  char name[100];
  std::snprintf(name, sizeof name, "frames %lld/%lld (%.1f M) beside flat %lld (%.1f M), %s",
                static_cast<long long>(wide), static_cast<long long>(narrow),
                1e-6 * parameter_count(frames), static_cast<long long>(flat.config.n_embd),
                1e-6 * parameter_count(flat), to_string(precision).c_str());
  std::printf("%-66s %7.0f frames/s beside %6.0f, ratio %.1f\n", name, fast, slow, fast / slow);
  std::fflush(stdout);
  return {{"name", name},         {"value", fast},        {"unit", "frames/s"}, {"limit", slow},
          {"limit_name", "flat"}, {"ratio", fast / slow}, {"goal", 5}};
}

}  // namespace

// frames_bench [--json FILE]
int main(int argc, char** argv) {
  try {
    Json results = Json::array();
    for (const Precision precision : {Precision::f32, Precision::bf16, Precision::int8})
      for (const auto& [wide, narrow] : {std::pair{128, 64}, std::pair{256, 128}})
        results.push_back(measure(wide, narrow, precision));
    if (argc == 3 && std::strcmp(argv[1], "--json") == 0)
      save_json(
          argv[2],
          {{"bench", "frames"}, {"kernels", to_string(best_kernel_level())}, {"results", results}});
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "frames_bench: " << error.what() << "\n";
    return 1;
  }
}
