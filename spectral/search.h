// The nearest windows of an index, exactly.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "spectral/index.h"

namespace mocaplm {

struct Neighbour {
  Eigen::Index row = 0;
  double similarity = 0;  // cosine (thesis 3.3); 0 where a row is all zeros
  double distance = 0;    // Euclidean, of the features as they were
};

// "cosine" or "euclidean" -> which of the two ranks.
enum class Measure { cosine, euclidean };
Measure parse_measure(const std::string& name);

// Which clips may be found: one value a clip of the index, not 0 for yes; empty for all.
using Scope = std::vector<char>;

struct SearchCounts {
  std::int64_t sketched = 0;  // rows that the coarse sketches could not rule out
  std::int64_t compared = 0;  // rows that were compared in full
};

// The k best rows for a query of index.dimensions() features, best first, of equal ones the first
// in the index; fewer where the scope has fewer. The coarse sketches (or the rows where there are
// none) give a bound for each row, the sketches a lower one for those that it leaves; rows whose
// bound is not below the k-th best so far are compared in full, in double precision (filter and
// refine; Seidl and Kriegel 1998). `threads`: 0 for all cores.
std::vector<Neighbour> nearest(const SpectralIndex& index, const float* query, Eigen::Index k,
                               Measure measure, const Scope& scope = {}, std::int64_t threads = 0,
                               SearchCounts* counts = nullptr);

// The same for many queries (n, dimensions) at once, by matrix products over all rows, in single
// precision. `scope_of(i)` is query i's; `skip(i)` a row that it must not find, or -1.
std::vector<std::vector<Neighbour>> nearest_of_many(
    const SpectralIndex& index, const Series& queries, Eigen::Index k, Measure measure,
    const std::function<Scope(Eigen::Index)>& scope_of,
    const std::function<Eigen::Index(Eigen::Index)>& skip, std::int64_t threads = 0);

}  // namespace mocaplm
