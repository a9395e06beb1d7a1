#include "evaluate/generated/asked_models.h"

#include <algorithm>

#include "common/error.h"
#include "common/progress.h"
#include "model/directory.h"

namespace mocaplm {

namespace {

constexpr std::size_t kInMemory = 256;  // requests whose prompts and answers are held at once

}  // namespace

std::vector<AskedModel> load_models(const GeneratedOptions& options, std::int64_t sequences) {
  std::vector<AskedModel> models;
  for (const std::filesystem::path& path : options.models) {
    const EngineOptions engine = {named_precision(options.precision), options.threads,
                                  std::clamp<std::int64_t>(sequences, 1, kMaxSequences)};
    if (load_description(path).masked())
      throw UsageError(path.string() +
                       " is a masked model, which fills gaps (infill) and goes on "
                       "with nothing: expected a causal one");
    models.push_back(
        {options.models.size() == 1 ? "model" : path.string(),
         std::make_unique<Generator>(load_model(path), resolve_model(path).string(), engine)});
  }
  return models;
}

void ask(AskedModel& model, std::size_t requests,
         const std::function<GenerateRequest(std::size_t)>& request,
         const std::function<void(std::size_t, GenerateResult&&)>& answer) {
  Progress bar("generate", requests, "dances");
  std::size_t done = 0;
  double share = 0;
  const auto told = [&](const GeneratedFrame& frame) {
    if (frame.index + 1 == frame.frames) ++done;
    share += 1 / static_cast<double>(frame.frames);
    bar.update(done, "", share / static_cast<double>(requests));
  };
  for (std::size_t first = 0; first < requests; first += kInMemory) {
    std::vector<GenerateRequest> some;
    for (std::size_t i = first; i < std::min(requests, first + kInMemory); ++i)
      some.push_back(request(i));
    std::vector<GenerateResult> results = model.generator->generate(some, told);
    for (std::size_t i = 0; i < results.size(); ++i) answer(first + i, std::move(results[i]));
  }
  bar.finish(model.name);
}

}  // namespace mocaplm
