// The demo's walk: procedural dances -> tokens -> pre-trained model -> fine-tuned model -> a
// generated dance and a classification table -> one page.
#pragma once

#include <filesystem>
#include <string>

namespace mocaplm {

struct WalkOptions {
  std::filesystem::path out = "demo";
  std::string genre = "waack";
  std::string dancer;    // default: the first dancer of the genre
  double minutes = 6.5;  // for all training together
  double seconds = 12;   // of the generated dance
  std::int64_t seed = 1;
  std::string device = "auto";
  int threads = 0;
};

// Fills options.out; an earlier demo there is replaced, anything else refused (UsageError). Throws
// UsageError for a genre or dancer that the dances do not have, before any work.
void walk(const WalkOptions& options);

}  // namespace mocaplm
