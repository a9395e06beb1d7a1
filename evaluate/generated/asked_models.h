// What every evaluation of generated motion is told on the command line, and the models it asks.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "generate/generator.h"

namespace mocaplm {

struct GeneratedOptions {
  std::vector<std::filesystem::path> models;
  std::filesystem::path data;
  std::string split = "test";
  std::vector<std::string> where;  // "label=value": only these clips
  bool conditions = true;          // tell a model the clip's labels, where it knows conditions
  double seed_seconds = 2;         // of a clip that are shown
  std::string precision = "bf16";
  int threads = 0;
  SamplingConfig sampling;
};

struct AskedModel {
  std::string name;  // "model" where it is the only one, else its path
  std::unique_ptr<Generator> generator;

  double fps() const { return generator->tokenizer().config().fps; }
};

// Loads them, to decode up to `sequences` dances side by side. Throws DataError for folders that
// are no sound model.
std::vector<AskedModel> load_models(const GeneratedOptions& options, std::int64_t sequences);

// Answers to all requests in their order, a bounded number in memory at a time; each is handed over
// as soon as its share is done. Shows a progress bar.
void ask(AskedModel& model, std::size_t requests,
         const std::function<GenerateRequest(std::size_t)>& request,
         const std::function<void(std::size_t, GenerateResult&&)>& answer);

}  // namespace mocaplm
