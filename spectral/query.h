// Which motions of a dataset are like a given one (thesis 3.4).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/settings.h"
#include "common/table.h"
#include "motion/dataset.h"
#include "motion/reading.h"
#include "spectral/config.h"
#include "spectral/search.h"

namespace mocaplm {

struct QueryConfig {
  std::string metric = "cosine";
  std::int64_t k = 10;
  std::string exclude_same = "clip";
  std::int64_t per_clip = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("metric", metric, {"cosine", "euclidean"}, "what ranks the windows");
    v.integer("k", k, 1, 100000, "neighbours");
    v.choice("exclude_same", exclude_same, {"clip", "group", "none"},
             "whether windows of the query's own clip, or of its whole group, are left out");
    v.integer("per_clip", per_clip, 1, 100000,
              "most windows of one clip that are listed (not with --evaluate)");
  }
};

struct QueryOptions {
  std::filesystem::path dataset, keep;  // `keep`: the folder of the index, empty for the dataset's
  std::string clip;                     // CLIP[:from-to] of the dataset, or a motion file
  MotionReading read;                   // of such a file
  SpectralConfig config;
  QueryConfig query;
  std::int64_t threads = 0;
};

struct QueryMatch {
  std::string clip;
  double from = 0, to = 0;  // seconds
  double query_from = 0;    // the query's window that it is like, seconds of the query's clip
  std::size_t entry = 0;    // in the dataset
  Neighbour neighbour;
};

struct QueryResult {
  Dataset dataset;
  Clip query;                       // the piece asked for
  double from = 0;                  // where it begins in its clip, seconds
  double seconds = 0;               // of a window
  std::vector<QueryMatch> matches;  // best first
  std::int64_t windows = 0;         // of the query
  std::int64_t searched = 0;        // windows of the index
  double milliseconds = 0;          // of the search of one window
  std::vector<std::string> notes;
};

// All windows of the query are searched for; a window of the index counts with the one that is most
// like it. Throws UsageError and DataError for pieces that are too short or lie outside their clip,
// and as index_of does.
QueryResult run_query(const QueryOptions& options);

// Clip, rank, similarity, time, labels.
Table query_table(const QueryResult& result, const QueryOptions& options);

// A match's motion at its clip's own rate.
Clip match_clip(const QueryResult& result, const QueryMatch& match);

// Which of the dataset's clips may be found for a query of `entry` (may be null). `clips`: base
// scope, one value a clip.
Scope without_same(const Dataset& dataset, const DatasetEntry* entry,
                   const std::string& exclude_same, Scope clips);

}  // namespace mocaplm
