#include "spectral/query.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/text.h"
#include "motion/clip_range.h"

namespace mocaplm {

namespace {

struct QueryRows {
  Series rows;
  std::vector<double> from;  // seconds
};

QueryRows query_rows(const RangedClip& piece, const SpectralIndex& index) {
  const SpectralConfig& config = index.config();
  const Clip clip = at_window_rate(piece.clip, config);
  const auto starts = window_starts(clip.frames(), config.window, config.stride);
  if (starts.empty())
    throw DataError(in_file(piece.clip.name), "the query " + too_short_text(piece.clip, config));
  QueryRows out;
  std::vector<Series> windows;
  for (const Eigen::Index first : starts) {
    windows.push_back(window_series(clip, first, config.window, config_joints(config)));
    out.from.push_back(piece.from + static_cast<double>(first) / config.fps);
  }
  out.rows = index.features().rows(windows);
  return out;
}

// The best rows over all windows of the query, each once, best first. `asked`: of each window.
struct Found {
  Neighbour neighbour;
  std::size_t query = 0;
};

std::vector<Found> best_rows(const SpectralIndex& index, const QueryRows& query, Eigen::Index asked,
                             Measure measure, const Scope& scope, std::int64_t threads) {
  std::map<Eigen::Index, Found> by_row;
  const auto better = [measure](const Neighbour& a, const Neighbour& b) {
    if (measure == Measure::euclidean && a.distance != b.distance) return a.distance < b.distance;
    if (measure == Measure::cosine && a.similarity != b.similarity)
      return a.similarity > b.similarity;
    return a.row < b.row;
  };
  for (Eigen::Index q = 0; q < query.rows.rows(); ++q)
    for (const Neighbour& one :
         nearest(index, query.rows.row(q).data(), asked, measure, scope, threads)) {
      const Found found{one, static_cast<std::size_t>(q)};
      const auto [at, fresh] = by_row.emplace(one.row, found);
      if (!fresh && better(one, at->second.neighbour)) at->second = found;
    }
  std::vector<Found> all;
  for (const auto& [row, found] : by_row) all.push_back(found);
  std::sort(all.begin(), all.end(),
            [&](const Found& a, const Found& b) { return better(a.neighbour, b.neighbour); });
  return all;
}

// The first k that take at most `per_clip` of each clip.
std::vector<Found> spread(const SpectralIndex& index, const std::vector<Found>& all,
                          const QueryConfig& config) {
  std::map<std::uint32_t, std::int64_t> taken;
  std::vector<Found> chosen;
  for (const Found& one : all)
    if (static_cast<std::int64_t>(chosen.size()) < config.k &&
        ++taken[index.window(one.neighbour.row).clip] <= config.per_clip)
      chosen.push_back(one);
  return chosen;
}

// More rows are asked for until enough clips are among them. What lies beyond the last row asked
// for is worse than all of them, so the first k of different clips are exact.
std::vector<Found> search(const SpectralIndex& index, const QueryRows& query,
                          const QueryConfig& config, const Scope& scope, std::int64_t threads) {
  const Measure measure = parse_measure(config.metric);
  for (Eigen::Index asked = 4 * config.k;; asked *= 4) {
    asked = std::min(asked, index.size());
    const std::vector<Found> chosen =
        spread(index, best_rows(index, query, asked, measure, scope, threads), config);
    if (static_cast<std::int64_t>(chosen.size()) >= config.k || asked >= index.size())
      return chosen;
  }
}

}  // namespace

Scope without_same(const Dataset& dataset, const DatasetEntry* entry,
                   const std::string& exclude_same, Scope clips) {
  if (clips.empty()) clips.assign(dataset.entries.size(), 1);
  if (entry == nullptr || exclude_same == "none") return clips;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (dataset.entries[i].name == entry->name ||
        (exclude_same == "group" && dataset.entries[i].group == entry->group))
      clips[i] = 0;
  return clips;
}

QueryResult run_query(const QueryOptions& options) {
  QueryResult result;
  check_config(options.config);
  result.dataset = load_dataset(options.dataset);
  const Dataset& dataset = result.dataset;
  const RangedClip piece = read_clip_range(options.clip, &dataset, options.read);
  if (piece.entry != nullptr)
    refuse_read_options(options.read,
                        " is for motion files; " + piece.entry->name + " is the dataset's clip");
  std::string note;
  const SpectralIndex index =
      index_of(dataset, options.config, options.keep, options.threads, &note);
  result.notes.push_back(note);
  const QueryRows query = query_rows(piece, index);
  const Scope scope = without_same(dataset, piece.entry, options.query.exclude_same, {});
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Found> found = search(index, query, options.query, scope, options.threads);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  result.query = piece.clip;
  result.from = piece.from;
  result.seconds = options.config.seconds();
  result.windows = query.rows.rows();
  result.searched = index.size();
  result.milliseconds = took.count() / static_cast<double>(result.windows);
  for (const Found& one : found) {
    const MotionWindow window = index.window(one.neighbour.row);
    QueryMatch match;
    match.entry = window.clip;
    match.clip = dataset.entries[match.entry].name;
    match.from = window.first / options.config.fps;
    match.to = std::min(match.from + result.seconds, dataset.entries[match.entry].seconds());
    match.query_from = query.from[one.query];
    match.neighbour = one.neighbour;
    result.matches.push_back(match);
  }
  if (result.matches.empty())
    throw DataError(in_file(options.dataset.string()),
                    "no windows are left beside the query's own " + options.query.exclude_same);
  if (index.clips_too_short() > 0)
    result.notes.push_back(std::to_string(index.clips_too_short()) + " of " +
                           std::to_string(index.clips().size()) +
                           " clips are shorter than a window and not in the index");
  return result;
}

Table query_table(const QueryResult& result, const QueryOptions& options) {
  const bool cosine = options.query.metric == "cosine";
  const std::vector<std::string> labels = result.dataset.label_names();
  std::vector<std::string> columns = {"clip",   "rank", cosine ? "cosine similarity" : "distance",
                                      "from s", "to s", "query from s"};
  columns.insert(columns.end(), labels.begin(), labels.end());
  Table table("like " + options.clip + ", by " + options.config.feature, columns);
  std::vector<int> digits = {-1, 0, 4, 2, 2, 2};
  digits.insert(digits.end(), labels.size(), -1);
  table.digits(digits);
  int rank = 0;
  for (const QueryMatch& match : result.matches) {
    std::vector<Json> cells = {
        match.clip, ++rank,   cosine ? match.neighbour.similarity : match.neighbour.distance,
        match.from, match.to, match.query_from};
    for (const std::string& label : labels) {
      const Labels& own = result.dataset.entries[match.entry].labels;
      const auto found = own.find(label);
      cells.push_back(found == own.end() ? Json("") : Json(found->second));
    }
    table.row(cells);
  }
  for (const std::string& note : result.notes) table.note(note);
  table.note("searched for " + std::to_string(result.windows) + " windows of " +
             format_fixed(result.seconds, 2) + " s among " + std::to_string(result.searched) +
             ", " + format_fixed(result.milliseconds, 2) + " ms each");
  table.note("settings: " + settings_json(options.config).dump());
  if (result.dataset.procedural) table.note("procedural dances: rules made them");
  return table;
}

Clip match_clip(const QueryResult& result, const QueryMatch& match) {
  const Clip whole = load_clip(result.dataset, result.dataset.entries[match.entry]);
  const auto first =
      std::min(static_cast<Eigen::Index>(std::llround(match.from * whole.fps)), whole.frames() - 1);
  const auto last = std::clamp(static_cast<Eigen::Index>(std::llround(match.to * whole.fps)),
                               first + 1, whole.frames());
  return slice(whole, first, last - first);
}

}  // namespace mocaplm
