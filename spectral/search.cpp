#include "spectral/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "common/error.h"
#include "common/parallel.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kRowsAWorker = 8192;  // rows that one worker takes at once
constexpr std::size_t kRefined = 512;  // rows compared in full before the bound is looked at again
constexpr std::size_t kPart = 128;     // of them, by one worker
constexpr Eigen::Index kQueries = 64;  // of many, in one product
// What rounding may take from a bound: sums of products of unit vectors in single precision.
constexpr float kRounding = 1e-5f;

// A row and what ranks it: the greater the better, of equals the first.
struct Ranked {
  double score = 0;
  Eigen::Index row = 0;
  bool operator<(const Ranked& other) const {
    return score > other.score || (score == other.score && row < other.row);
  }
};

// The k best seen.
class Best {
 public:
  explicit Best(Eigen::Index k) : k_(static_cast<std::size_t>(k)) {}
  bool full() const { return queue_.size() >= k_; }
  // What a row must reach to come in.
  double least() const {
    return full() ? queue_.top().score : -std::numeric_limits<double>::infinity();
  }
  void add(const Ranked& one) {
    if (full() && !(one < queue_.top())) return;
    if (full()) queue_.pop();
    queue_.push(one);
  }
  std::vector<Ranked> sorted() {
    std::vector<Ranked> all;
    for (; !queue_.empty(); queue_.pop()) all.push_back(queue_.top());
    std::reverse(all.begin(), all.end());
    return all;
  }

 private:
  std::size_t k_;
  std::priority_queue<Ranked> queue_;  // the worst on top
};

struct Scorer {
  Measure measure;
  double length;  // of the query as it was
  // From the product of unit vectors: the cosine, or the distance's square, negative.
  double operator()(double product, double row_length) const {
    if (measure == Measure::cosine) return product;
    return -(length * length + row_length * row_length - 2 * length * row_length * product);
  }
};

bool in_scope(const SpectralIndex& index, const Scope& scope, Eigen::Index row) {
  return scope.empty() || scope[index.window(row).clip] != 0;
}

double full_product(const SpectralIndex& index, const Eigen::VectorXd& unit, Eigen::Index row) {
  return index.rows().row(row).cast<double>().dot(unit);
}

// From the differences themselves: near 0 the products would cancel.
double squared_distance(const SpectralIndex& index, const Eigen::VectorXd& unit, double length,
                        Eigen::Index row) {
  const double row_length = index.lengths()[row];
  return (index.rows().row(row).cast<double>() * row_length - unit.transpose() * length)
      .squaredNorm();
}

double full_score(const SpectralIndex& index, const Eigen::VectorXd& unit, const Scorer& scorer,
                  Eigen::Index row) {
  return scorer.measure == Measure::cosine ? full_product(index, unit, row)
                                           : -squared_distance(index, unit, scorer.length, row);
}

Neighbour neighbour(const SpectralIndex& index, const Eigen::VectorXd& unit, double length,
                    Eigen::Index row) {
  return {row, full_product(index, unit, row),
          std::sqrt(squared_distance(index, unit, length, row))};
}

// One search: bounds of all rows, then the rows that they leave.
class Search {
 public:
  Search(const SpectralIndex& index, const float* query, Eigen::Index k, Measure measure,
         const Scope& scope, std::int64_t threads)
      : index_(index), scope_(scope), k_(k), threads_(threads), best_(k) {
    Series row = Eigen::Map<const Series>(query, 1, index.dimensions());
    scorer_ = {measure, static_cast<double>(normalise_rows(row)[0])};
    unit_ = row.row(0).transpose().cast<double>();
    key_ = row.row(0).transpose();
    if (index.sketch_dimensions() == 0) return;
    const Series sketch = index.sketch_of(row);
    sketch_ = sketch.row(0).transpose();
    key_ = make_coarse(sketch).row(0).transpose();
  }

  std::vector<Neighbour> run(SearchCounts* counts) {
    bound_all();
    // The k most promising give what the others must reach.
    std::vector<Eigen::Index> first = std::move(promising_);
    compare(first.data(), first.size());
    std::sort(first.begin(), first.end());
    std::vector<Ranked> left = candidates(first);
    std::sort(left.begin(), left.end());
    std::vector<Eigen::Index> rows;
    for (const Ranked& one : left) rows.push_back(one.row);
    std::size_t at = 0;
    for (; at < left.size() && left[at].score >= best_.least(); at += kRefined)
      compare(rows.data() + at, std::min(kRefined, rows.size() - at));
    if (counts != nullptr) {
      counts->sketched = sketched_;
      counts->compared = static_cast<std::int64_t>(first.size() + std::min(at, left.size()));
    }
    std::vector<Neighbour> found;
    for (const Ranked& one : best_.sorted())
      found.push_back(neighbour(index_, unit_, scorer_.length, one.row));
    return found;
  }

 private:
  std::size_t blocks() const {
    return static_cast<std::size_t>((index_.size() + kRowsAWorker - 1) / kRowsAWorker);
  }

  void bound_all() {
    bounds_.resize(index_.size());
    std::vector<Best> best(blocks(), Best(k_));
    parallel_for(blocks(), threads_, [&](std::size_t b) {
      const Eigen::Index first = static_cast<Eigen::Index>(b) * kRowsAWorker;
      const Eigen::Index count = std::min(kRowsAWorker, index_.size() - first);
      const auto keys = sketch_.size() > 0 ? index_.coarse() : index_.rows();
      auto bounds = bounds_.segment(first, count);
      bounds.noalias() = keys.middleRows(first, count) * key_;
      const auto lengths = index_.lengths();
      for (Eigen::Index i = 0; i < count; ++i) bounds[i] = bound(bounds[i], lengths[first + i]);
      double least = best[b].least();
      for (Eigen::Index i = 0; i < count; ++i)
        if (bounds[i] > least && in_scope(index_, scope_, first + i)) {
          best[b].add({bounds[i], first + i});
          least = best[b].least();
        }
    });
    Best all(k_);
    for (Best& one : best)
      for (const Ranked& ranked : one.sorted()) all.add(ranked);
    for (const Ranked& ranked : all.sorted()) promising_.push_back(ranked.row);
  }

  // From the product of the sketches of two unit vectors: what the row's score cannot exceed.
  float bound(float product, float row_length) const {
    product += kRounding;
    if (scorer_.measure == Measure::cosine) return product;
    const auto length = static_cast<float>(scorer_.length);
    // The lengths' rounding counts, too: relative to both squares.
    return 2 * length * row_length * product -
           (1 - kRounding) * (length * length + row_length * row_length);
  }

  float fine_bound(Eigen::Index row) const {
    if (sketch_.size() == 0) return bounds_[row];
    return bound(index_.sketch().row(row).dot(sketch_), index_.lengths()[row]);
  }

  // Rows whose bounds reach what is needed, but for those already compared (sorted).
  std::vector<Ranked> candidates(const std::vector<Eigen::Index>& compared) {
    if (!best_.full()) return {};  // all of the scope have been compared
    const auto least = static_cast<float>(best_.least());
    std::vector<std::vector<Ranked>> parts(blocks());
    std::vector<std::int64_t> sketched(blocks());
    parallel_for(blocks(), threads_, [&](std::size_t b) {
      const Eigen::Index first = static_cast<Eigen::Index>(b) * kRowsAWorker;
      const Eigen::Index last = std::min(first + kRowsAWorker, index_.size());
      for (Eigen::Index row = first; row < last; ++row) {
        if (bounds_[row] < least || !in_scope(index_, scope_, row) ||
            std::binary_search(compared.begin(), compared.end(), row))
          continue;
        ++sketched[b];
        if (const float fine = fine_bound(row); fine >= least) parts[b].push_back({fine, row});
      }
    });
    sketched_ = std::accumulate(sketched.begin(), sketched.end(), std::int64_t{0});
    std::vector<Ranked> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  void compare(const Eigen::Index* rows, std::size_t count) {
    std::vector<double> scores(count);
    const std::size_t parts = (count + kPart - 1) / kPart;
    parallel_for(parts, threads_, [&](std::size_t part) {
      for (std::size_t i = part * kPart; i < std::min(count, (part + 1) * kPart); ++i)
        scores[i] = full_score(index_, unit_, scorer_, rows[i]);
    });
    for (std::size_t i = 0; i < count; ++i) best_.add({scores[i], rows[i]});
  }

  const SpectralIndex& index_;
  const Scope& scope_;
  Eigen::Index k_;
  std::int64_t threads_;
  Best best_;
  Scorer scorer_{Measure::cosine, 0};
  Eigen::VectorXd unit_;          // the query, of length 1
  Eigen::VectorXf key_, bounds_;  // what meets the coarse sketches (or rows), and what that gives
  Eigen::VectorXf sketch_;        // of the query; empty where there are none
  std::int64_t sketched_ = 0;
  std::vector<Eigen::Index> promising_;
};

}  // namespace

Measure parse_measure(const std::string& name) {
  if (name != "cosine" && name != "euclidean")
    throw UsageError("metric \"" + name + "\": expected cosine or euclidean");
  return name == "cosine" ? Measure::cosine : Measure::euclidean;
}

std::vector<Neighbour> nearest(const SpectralIndex& index, const float* query, Eigen::Index k,
                               Measure measure, const Scope& scope, std::int64_t threads,
                               SearchCounts* counts) {
  if (k < 1) throw UsageError("k is " + std::to_string(k) + ", expected 1 or more");
  return Search(index, query, k, measure, scope, threads).run(counts);
}

std::vector<std::vector<Neighbour>> nearest_of_many(
    const SpectralIndex& index, const Series& queries, Eigen::Index k, Measure measure,
    const std::function<Scope(Eigen::Index)>& scope_of,
    const std::function<Eigen::Index(Eigen::Index)>& skip, std::int64_t threads) {
  if (k < 1) throw UsageError("k is " + std::to_string(k) + ", expected 1 or more");
  std::vector<std::vector<Neighbour>> found(static_cast<std::size_t>(queries.rows()));
  const auto blocks = static_cast<std::size_t>((queries.rows() + kQueries - 1) / kQueries);
  parallel_for(blocks, threads, [&](std::size_t b) {
    const Eigen::Index from = static_cast<Eigen::Index>(b) * kQueries;
    const Eigen::Index count = std::min(kQueries, queries.rows() - from);
    Series units = queries.middleRows(from, count);
    const Eigen::VectorXf lengths = normalise_rows(units);
    std::vector<Best> best(static_cast<std::size_t>(count), Best(k));
    std::vector<Scope> scopes;
    for (Eigen::Index q = 0; q < count; ++q) scopes.push_back(scope_of(from + q));
    const Eigen::Index step = std::min<Eigen::Index>(1024, index.size());
    Series products(count, step);
    for (Eigen::Index first = 0; first < index.size(); first += step) {
      const Eigen::Index rows = std::min(step, index.size() - first);
      products.leftCols(rows).noalias() = units * index.rows().middleRows(first, rows).transpose();
      for (Eigen::Index q = 0; q < count; ++q) {
        const auto at = static_cast<std::size_t>(q);
        const Scorer scorer{measure, lengths[q]};
        const Eigen::Index never = skip(from + q);
        for (Eigen::Index i = 0; i < rows; ++i) {
          const Eigen::Index row = first + i;
          const double score = scorer(products(q, i), index.lengths()[row]);
          if (score > best[at].least() && row != never && in_scope(index, scopes[at], row))
            best[at].add({score, row});
        }
      }
    }
    for (Eigen::Index q = 0; q < count; ++q) {
      const Eigen::VectorXd unit = units.row(q).transpose().cast<double>();
      for (const Ranked& one : best[static_cast<std::size_t>(q)].sorted())
        found[static_cast<std::size_t>(from + q)].push_back(
            neighbour(index, unit, lengths[q], one.row));
    }
  });
  return found;
}

}  // namespace mocaplm
