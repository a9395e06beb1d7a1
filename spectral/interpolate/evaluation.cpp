#include "spectral/interpolate/evaluation.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/progress.h"
#include "common/random.h"
#include "common/text.h"
#include "motion/chosen_clips.h"
#include "numeric/quantiles.h"
#include "spectral/interpolate/interpolate.h"
#include "spectral/measures.h"

namespace mocaplm {

namespace {

constexpr double kLeastSeconds = 2;  // of a clip; the thesis's windows have 2.13
// Of the rougher of both motions: a result above it is called rougher than both. Rounding aside, no
// mean of two motions comes there.
constexpr double kRougher = 1.001;

// A kind of features and the frequencies that take part.
struct Kind {
  std::string name, range;
  InterpolateConfig config;
};

std::vector<Kind> kinds_of(const InterpolateConfig& config) {
  const std::string range = format_number(config.from_hz) + "-" + format_number(config.to_hz);
  std::vector<Kind> kinds;
  for (const char* target : {"dct", "stft", "pca", "own_pca"}) {
    const bool by_frequency = target == std::string("dct") || target == std::string("stft");
    Kind kind{target, by_frequency ? range : "", config};
    kind.config.target = target;
    kinds.push_back(kind);
    if (!by_frequency) continue;
    kind.name += " all";
    kind.range = "0-" + format_number(config.fps / 2);
    kind.config.from_hz = 0;
    kind.config.to_hz = config.fps / 2;
    kinds.push_back(kind);
  }
  return kinds;
}

// What is kept of one interpolation.
struct Outcome {
  Similarities stft;
  double original = 0, target = 0, result = 0;  // roughness
  double error_left = 0;                        // of the features' error to the target's, a share

  bool between() const {
    return std::min(stft.result_original, stft.result_target) > stft.original_target;
  }
  double beside_rougher() const {
    const double rougher = std::max(original, target);
    return rougher > 0 ? result / rougher : 1;
  }
};

Outcome outcome_of(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  const InterpolateResult found = interpolate(a, b, config);
  Outcome outcome;
  outcome.stft = found.stft;
  outcome.original = roughness(found.original);
  outcome.target = roughness(found.target);
  outcome.result = roughness(found.result);
  outcome.error_left = found.error_before > 0 ? found.error_after / found.error_before : 0;
  return outcome;
}

template <class Value>
double mean_of(const std::vector<Outcome>& outcomes, const Value& value) {
  double sum = 0;
  for (const Outcome& one : outcomes) sum += value(one);
  return sum / static_cast<double>(outcomes.size());
}

std::vector<Json> summary_cells(const Kind& kind, const std::vector<Outcome>& all) {
  const auto mean = [&](const auto& value) { return mean_of(all, value); };
  std::vector<double> beside;
  for (const Outcome& one : all) beside.push_back(one.beside_rougher());
  return {kind.name,
          kind.range,
          100 * mean([](const Outcome& o) { return o.error_left; }),
          mean([](const Outcome& o) { return o.stft.original_target; }),
          mean([](const Outcome& o) { return o.stft.result_original; }),
          mean([](const Outcome& o) { return o.stft.result_target; }),
          100 * mean([](const Outcome& o) { return double(o.between()); }),
          mean([](const Outcome& o) { return o.original; }),
          mean([](const Outcome& o) { return o.target; }),
          mean([](const Outcome& o) { return o.result; }),
          median_of(beside),
          *std::max_element(beside.begin(), beside.end()),
          100 * mean([](const Outcome& o) { return double(o.beside_rougher() > kRougher); })};
}

// A row a pair: both names, then `before` of the pair and `after` of each kind.
template <class Before, class After>
Table pair_table(const std::string& title, std::vector<std::string> columns, int digits,
                 const std::vector<std::pair<std::string, std::string>>& names,
                 const std::vector<std::vector<Outcome>>& outcomes, const Before& before,
                 const After& after) {
  Table table(title, columns);
  std::vector<int> places(columns.size(), digits);
  places[0] = places[1] = -1;
  table.digits(places);
  for (std::size_t p = 0; p < names.size(); ++p) {
    std::vector<Json> cells = {names[p].first, names[p].second};
    for (const double value : before(outcomes[0][p])) cells.push_back(value);
    for (const std::vector<Outcome>& kind : outcomes)
      for (const double value : after(kind[p])) cells.push_back(value);
    table.row(cells);
  }
  return table;
}

Table similarity_table(const std::vector<Kind>& kinds,
                       const std::vector<std::pair<std::string, std::string>>& names,
                       const std::vector<std::vector<Outcome>>& outcomes) {
  std::vector<std::string> columns = {"original (O)", "target (T)", "O-T"};
  for (const Kind& kind : kinds)
    columns.insert(columns.end(), {kind.name + " I-O", kind.name + " I-T"});
  return pair_table(
      "cosine similarities of STFTs, each pair", columns, 3, names, outcomes,
      [](const Outcome& o) { return std::vector<double>{o.stft.original_target}; },
      [](const Outcome& o) {
        return std::vector<double>{o.stft.result_original, o.stft.result_target};
      });
}

Table roughness_table(const std::vector<Kind>& kinds,
                      const std::vector<std::pair<std::string, std::string>>& names,
                      const std::vector<std::vector<Outcome>>& outcomes) {
  std::vector<std::string> columns = {"original (O)", "target (T)", "O", "T"};
  for (const Kind& kind : kinds) columns.push_back(kind.name);
  return pair_table(
      "roughness m/s^3, each pair", columns, 0, names, outcomes,
      [](const Outcome& o) {
        return std::vector<double>{o.original, o.target};
      },
      [](const Outcome& o) { return std::vector<double>{o.result}; });
}

Clip beginning(const Dataset& dataset, std::size_t entry, double seconds) {
  const Clip clip = load_clip(dataset, dataset.entries[entry]);
  const auto most = static_cast<Eigen::Index>(std::llround(seconds * clip.fps));
  return slice(clip, 0, std::min(clip.frames(), std::max<Eigen::Index>(most, 1)));
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> different_pairs(const Dataset& dataset,
                                                                 const std::string& label,
                                                                 const InterpolatePairs& config) {
  check_label(dataset, label, "--evaluate");
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < dataset.entries.size(); ++i) {
    const DatasetEntry& entry = dataset.entries[i];
    if ((config.split == "all" || entry.split == config.split) && entry.labels.count(label) > 0 &&
        entry.seconds() >= kLeastSeconds)
      free.push_back(i);
  }
  Random random(static_cast<std::uint64_t>(config.seed));
  random.shuffle(free);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto value = [&](std::size_t entry) { return dataset.entries[entry].labels.at(label); };
  while (!free.empty() && static_cast<std::int64_t>(pairs.size()) < config.pairs) {
    const std::size_t first = free.front();
    free.erase(free.begin());
    const auto other = std::find_if(free.begin(), free.end(),
                                    [&](std::size_t one) { return value(one) != value(first); });
    if (other == free.end()) break;  // all that are left are alike
    pairs.emplace_back(first, *other);
    free.erase(other);
  }
  if (pairs.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "has no two clips of " + format_number(kLeastSeconds) + " s in split \"" +
                        config.split + "\" that differ in their " + label);
  return pairs;
}

std::vector<Table> evaluate_interpolate(const InterpolateEvaluation& options) {
  const Dataset dataset = load_dataset(options.dataset);
  const auto pairs = different_pairs(dataset, options.label, options.pairs);
  const std::vector<Kind> kinds = kinds_of(options.config);
  std::vector<std::vector<Outcome>> outcomes(kinds.size());
  std::vector<std::pair<std::string, std::string>> names;
  Progress progress("interpolate", pairs.size() * kinds.size(), "motions");
  for (const auto& [first, second] : pairs) {
    const Clip a = beginning(dataset, first, options.pairs.seconds);
    const Clip b = beginning(dataset, second, options.pairs.seconds);
    names.emplace_back(a.name, b.name);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      outcomes[k].push_back(outcome_of(a, b, kinds[k].config));
      progress.add();
    }
  }
  progress.finish();
  Table summary(
      "interpolation of " + std::to_string(pairs.size()) + " pairs that differ in " + options.label,
      {"features", "Hz", "error left %", "O-T", "I-O", "I-T", "I between %", "roughness O", "T",
       "I", "I / rougher", "most", "rougher than both %"});
  summary.digits({-1, -1, 1, 3, 3, 3, 0, 0, 0, 0, 2, 2, 0});
  for (std::size_t k = 0; k < kinds.size(); ++k) summary.row(summary_cells(kinds[k], outcomes[k]));
  summary.note(
      "O original, T target, I interpolated; cosine similarities of STFTs, roughness in "
      "m/s^3, means over the pairs; I / rougher: median of I beside the rougher of O, T");
  if (static_cast<std::int64_t>(pairs.size()) < options.pairs.pairs)
    summary.note("the clips make no more than " + std::to_string(pairs.size()) + " pairs");
  Json settings = settings_json(options.config);
  settings.erase("target");  // the rows name it
  settings.update(settings_json(options.pairs));
  summary.note("settings: " + settings.dump());
  if (dataset.procedural) summary.note("procedural dances: rules made them");
  return {summary, similarity_table(kinds, names, outcomes),
          roughness_table(kinds, names, outcomes)};
}

}  // namespace mocaplm
