#include "evaluate/generated/forecast.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"
#include "evaluate/generated/forecast_report.h"
#include "motion/chosen_clips.h"
#include "motion/resample.h"
#include "motion/skeleton.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

Eigen::Index frames_of(double seconds, double fps) {
  return static_cast<Eigen::Index>(std::llround(seconds * fps));
}

void check(const ForecastOptions& options) {
  if (options.horizons.empty()) throw UsageError("--horizons: expected at least one");
  for (const double horizon : options.horizons)
    if (!(horizon <= 60000) || frames_of(horizon / 1000, options.fps) < 1)
      throw UsageError("--horizons " + format_number(horizon) + ": expected a frame (" +
                       format_number(1000 / options.fps) + " ms) to 60000 ms");
  if (frames_of(options.seed_seconds, options.fps) < 2)
    throw UsageError("--seed-seconds " + format_number(options.seed_seconds) +
                     ": expected two frames at the least");
}

ForecastMaterial read_material(const ForecastOptions& options) {
  const Dataset dataset = load_dataset(options.data);
  const auto entries = chosen_entries(dataset, options.split, options.where);
  const Eigen::Index seed = frames_of(options.seed_seconds, options.fps),
                     ahead = frames_of(options.horizons.back() / 1000, options.fps);
  std::vector<std::vector<ForecastWindow>> of_clip(entries.size());
  parallel_for(entries.size(), options.threads, [&](std::size_t i) {
    const Clip clip = resample(load_clip(dataset, entries[i]), options.fps);
    of_clip[i] = forecast_windows(clip, seed, ahead);
  });
  ForecastMaterial material;
  material.clips = entries.size();
  material.slowest = entries[0].fps;
  std::vector<ForecastWindow> all;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    material.slowest = std::min(material.slowest, entries[i].fps);
    material.short_clips += of_clip[i].empty() ? 1 : 0;
    std::move(of_clip[i].begin(), of_clip[i].end(), std::back_inserter(all));
  }
  material.found = all.size();
  if (all.empty())
    throw DataError(in_file(options.data.string()),
                    "no clip of split \"" + options.split + "\" is long enough for a window of " +
                        format_number(options.seed_seconds) +
                        " s and 1 s more; give a shorter --seed-seconds");
  const std::size_t wanted = options.windows > 0
                                 ? std::min(all.size(), static_cast<std::size_t>(options.windows))
                                 : all.size();
  for (std::size_t i = 0; i < wanted; ++i)
    material.windows.push_back(std::move(all[i * all.size() / wanted]));
  return material;
}

// The protocol's joints that all models have, or all of them.
std::vector<int> counted_joints(const ForecastOptions& options,
                                const std::vector<AskedModel>& models) {
  std::vector<int> joints;
  for (const int joint : forecast_joints())
    if (options.all_joints || std::all_of(models.begin(), models.end(), [&](const AskedModel& m) {
          const std::vector<int>& known = m.generator->tokenizer().joints();
          return std::find(known.begin(), known.end(), joint) != known.end();
        }))
      joints.push_back(joint);
  if (joints.empty())
    throw UsageError(
        "the models share none of the protocol's joints; --all-joints counts the "
        "joints that they lack as still");
  return joints;
}

class Comparison {
 public:
  Comparison(const ForecastOptions& options, ForecastMaterial material, std::vector<int> joints)
      : options_(options),
        material_(std::move(material)),
        ahead_(frames_of(options.horizons.back() / 1000, options.fps)),
        metrics_(std::move(joints), targets(material_)) {}

  void add_simple(const std::string& name, Clip (*forecast)(const Clip&, Eigen::Index)) {
    std::vector<ForecastScores> scores(material_.windows.size());
    parallel_for(scores.size(), options_.threads, [&](std::size_t i) {
      const ForecastWindow& window = material_.windows[i];
      scores[i] = score(forecast(window.seed, ahead_), window);
    });
    rows_.emplace_back(name, mean(scores));
  }

  // Greedy, then the mean and the best of the samples.
  void add_model(AskedModel& model) {
    const std::size_t windows = material_.windows.size(),
                      each = 1 + static_cast<std::size_t>(options_.samples);
    std::vector<ForecastScores> scores(windows * each);  // of a window: greedy, then the samples
    const auto request = [&](std::size_t i) {
      const Clip& seed = material_.windows[i / each].seed;
      GenerateRequest r = model_request(seed, ahead_, *model.generator);
      if (options_.conditions)
        r.labels = known_conditions(model.generator->tokenizer(),
                                    model.generator->description().conditions, seed.labels);
      r.sampling = options_.sampling;
      r.sampling.strategy = i % each == 0 ? "greedy" : "sample";
      r.sampling.seed = (options_.sampling.seed + static_cast<std::int64_t>(i)) % 2147483647;
      return r;
    };
    ask(model, scores.size(), request, [&](std::size_t i, GenerateResult&& result) {
      const ForecastWindow& window = material_.windows[i / each];
      scores[i] = score(model_forecast(window.seed, ahead_, result, *model.generator), window);
    });
    std::vector<ForecastScores> greedy, sampled, best;
    for (std::size_t w = 0; w < windows; ++w) {
      const auto first = scores.begin() + static_cast<std::ptrdiff_t>(w * each);
      greedy.push_back(*first);
      if (each == 1) continue;
      const std::vector<ForecastScores> samples(first + 1,
                                                first + static_cast<std::ptrdiff_t>(each));
      sampled.push_back(mean(samples));
      best.push_back(best_of(samples));
    }
    const std::string of = " of " + std::to_string(options_.samples);
    rows_.emplace_back(model.name + ", greedy", mean(greedy));
    if (each == 1) return;
    rows_.emplace_back(model.name + ", mean" + of, mean(sampled));
    rows_.emplace_back(model.name + ", best" + of, mean(best));
  }

  const ForecastMaterial& material() const { return material_; }
  const std::vector<ForecastRow>& rows() const { return rows_; }

 private:
  static std::vector<Clip> targets(const ForecastMaterial& material) {
    std::vector<Clip> clips;
    for (const ForecastWindow& window : material.windows) clips.push_back(window.target);
    return clips;
  }

  ForecastScores score(const Clip& forecast, const ForecastWindow& window) const {
    const ForecastErrors errors = metrics_.errors(forecast, window.target);
    ForecastScores scores;
    for (const double horizon : options_.horizons)
      scores.push_back(score_until(errors, frames_of(horizon / 1000, options_.fps), horizon));
    return scores;
  }

  ForecastScores mean(const std::vector<ForecastScores>& all) const {
    ForecastScores sum(options_.horizons.size());
    for (const ForecastScores& one : all)
      for (std::size_t h = 0; h < sum.size(); ++h)
        for (const ForecastMetric& metric : forecast_metrics())
          sum[h].*metric.value += one[h].*metric.value / static_cast<double>(all.size());
    return sum;
  }

  // Of each metric and horizon its own best.
  static ForecastScores best_of(const std::vector<ForecastScores>& samples) {
    ForecastScores best = samples[0];
    for (const ForecastScores& one : samples)
      for (std::size_t h = 0; h < best.size(); ++h)
        for (const ForecastMetric& metric : forecast_metrics()) {
          double& kept = best[h].*metric.value;
          const double value = one[h].*metric.value;
          kept = metric.more_is_better ? std::max(kept, value) : std::min(kept, value);
        }
    return best;
  }

  const ForecastOptions& options_;
  ForecastMaterial material_;
  Eigen::Index ahead_;
  ForecastMetrics metrics_;
  std::vector<ForecastRow> rows_;
};

}  // namespace

std::vector<Table> forecast_tables(const ForecastOptions& given) {
  ForecastOptions options = given;
  std::sort(options.horizons.begin(), options.horizons.end());
  check(options);
  constexpr std::int64_t kAtOnce = 16;
  std::vector<AskedModel> models = load_models(options, kAtOnce);
  const std::vector<int> joints = counted_joints(options, models);
  Comparison comparison(options, read_material(options), joints);
  comparison.add_simple("zero velocity", zero_velocity);
  comparison.add_simple("linear extrapolation", linear_extrapolation);
  for (AskedModel& model : models) comparison.add_model(model);
  return forecast_report(options, comparison.material(), joints, models, comparison.rows());
}

}  // namespace mocaplm
