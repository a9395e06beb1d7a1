// How well the nearest windows tell a label (thesis 3.4 and Tables 3.1 and 3.2).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"
#include "spectral/query.h"

namespace mocaplm {

// The most frequent label; of equally frequent ones that of the nearest neighbour. Not empty.
std::string vote(const std::vector<std::string>& labels);
// -sum p log10 p of the labels' shares (equation 3.4, in bans). 0 for none.
double entropy_in_bans(const std::vector<std::string>& labels);

struct QueryEvaluation {
  std::filesystem::path dataset, keep;
  SpectralConfig config;
  QueryConfig query;
  std::vector<std::string> labels;                             // at least one
  std::vector<std::string> features = {"stft", "dct", "pca"};  // a row each, for each metric
  std::vector<std::string> metrics = {"cosine", "euclidean"};
  std::string split = "test";   // whose windows are queries; "all" for every split
  std::string against = "all";  // whose windows may be found
  std::int64_t threads = 0;
};

// A row for each feature and metric: for each label the share of queries whose vote is right, the
// mean entropy of their neighbours' labels, and precision at k (the share of neighbours with the
// query's label); below it what the most frequent label and neighbours by chance would give. Only
// clips that have all of the labels take part. A query's own window is never found. Throws
// UsageError for labels, features or metrics that are not known, DataError when a split is empty or
// nothing is left to find.
Table evaluate_query(const QueryEvaluation& options);

}  // namespace mocaplm
