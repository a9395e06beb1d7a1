#include "emulator/evaluation/tables.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "numeric/quantiles.h"

namespace mocaplm {

namespace {

constexpr double kLevel = 0.05;

std::vector<std::string> columns(const std::string& first, const std::vector<std::string>& more,
                                 const EvaluationOptions& options) {
  std::vector<std::string> all = {first};
  all.insert(all.end(), more.begin(), more.end());
  all.insert(all.end(), options.scheme.begin(), options.scheme.end());
  return all;
}

std::string first_column(const EvaluationOptions& options) {
  return options.label.empty() ? "motion" : options.label;
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Table errors_table(const Evaluation& evaluation) {
  Table table("Table 1: mean reconstruction errors of sequential PCA, radians over all limbs",
              {first_column(evaluation.options), "frames", "d1 x d2", "IS-TVF/PCA",
               "IS-TVF/PCA, unseen", "SIEM/PCA", "SIEM/PCA, unseen"});
  table.digits({-1, -1, -1, 4, 4, 4, 4});
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {
        one.name, one.frames,
        std::to_string(one.errors[0].d1) + " x " + std::to_string(one.errors[0].d2)};
    for (const RepresentationError& error : one.errors) {
      row.push_back(error.fit);
      row.push_back(error.unseen);
    }
    table.row(std::move(row));
  }
  return table;
}

Table p_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  Table table("Table 2: p-values of the two-sample test against unseen clips",
              columns(first_column(options), {"fit", "unseen", "real"}, options));
  std::vector<int> digits(4 + options.scheme.size(), 3);
  digits[0] = digits[1] = digits[2] = -1;
  table.digits(digits);
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {one.name, one.fit, one.test, one.real.p};
    for (const SchemeResult& scheme : one.schemes) row.push_back(scheme.unseen.p);
    table.row(std::move(row));
  }
  table.note("real: clips fitted to against unseen ones; the others: " +
             std::to_string(options.samples) + " simulated motions against unseen clips; " +
             std::to_string(options.permutations) + " permutations");
  for (const auto& left_out : evaluation.left_out) table.note("left out: " + left_out.second);
  if (evaluation.procedural) table.note("the data are procedural dances, not motion capture");
  return table;
}

// Of one column over the splits: the median, and how many are below the level.
std::pair<double, int> over_splits(const ClassReport& one, std::size_t column) {
  std::vector<double> p;
  for (const std::vector<double>& split : one.splits) p.push_back(split[column]);
  const auto below =
      std::count_if(p.begin(), p.end(), [](double value) { return value <= kLevel; });
  return {median_of(p), static_cast<int>(below)};
}

Table splits_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  Table table("Table 2 over " + std::to_string(options.splits) +
                  " splits: median p-value (splits with p <= 0.05)",
              columns(first_column(options), {"real"}, options));
  std::vector<std::vector<double>> medians(1 + options.scheme.size());
  std::vector<int> rejected(medians.size(), 0);
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {one.name};
    for (std::size_t k = 0; k < medians.size(); ++k) {
      const auto [median, below] = over_splits(one, k);
      row.push_back(format_fixed(median, 3) + " (" + std::to_string(below) + ")");
      medians[k].push_back(median);
      rejected[k] += below;
    }
    table.row(std::move(row));
  }
  const std::size_t tests = evaluation.classes.size() * static_cast<std::size_t>(options.splits);
  std::vector<Json> all = {"all"};
  for (std::size_t k = 0; k < medians.size(); ++k)
    all.push_back(format_fixed(median_of(medians[k]), 3) + " (" + std::to_string(rejected[k]) +
                  " of " + std::to_string(tests) + ")");
  table.row(std::move(all));
  return table;
}

Table fitted_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  Table table("Table 2, as the paper has it: p-values against the clips fitted to",
              columns(first_column(options), {}, options));
  table.digits(std::vector<int>(1 + options.scheme.size(), 3));
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {one.name};
    for (const SchemeResult& scheme : one.schemes) row.push_back(scheme.fitted.p);
    table.row(std::move(row));
  }
  return table;
}

// One row a model of level one, one column a model of level two: all rows have the same.
Table two_level_table(const Evaluation& evaluation) {
  std::vector<std::string> names = {first_column(evaluation.options), "level one"};
  const std::vector<std::string> models = TwoLevelOptions().level_two;
  names.insert(names.end(), models.begin(), models.end());
  Table table("Table 3: p-values of the two-level simulation, by the model of level two", names);
  std::vector<int> digits(names.size(), 4);
  digits[0] = digits[1] = -1;
  table.digits(digits);
  for (const ClassReport& one : evaluation.classes)
    for (std::size_t i = 0; i < one.two_level.size(); i += models.size()) {
      std::vector<Json> row = {one.name, one.two_level[i].level_one};
      for (std::size_t k = 0; k < models.size(); ++k) row.push_back(one.two_level[i + k].test.p);
      table.row(std::move(row));
    }
  table.note(std::to_string(evaluation.options.level_one) + " motions of level one, " +
             std::to_string(evaluation.options.level_two) +
             " of them set aside and compared with as many of level two; IG and MVG with the "
             "representation of level one");
  return table;
}

std::string mean_and_variance(const Variability& v) {
  return format_fixed(v.mean, 4) + " (" + format_fixed(v.variance, 4) + ")";
}

Table variability_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  Table table("Table 4: variability of the quantised sequences, mean (variance)",
              columns(first_column(options), {"original", "unseen"}, options));
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {one.name, mean_and_variance(one.original.variability),
                             mean_and_variance(one.unseen.variability)};
    for (const QuantisedResult& quantised : one.quantised)
      row.push_back(mean_and_variance(quantised.variability));
    table.row(std::move(row));
  }
  table.note(std::to_string(evaluation.clusters.count()) + " canonical postures found among " +
             std::to_string(evaluation.clusters.postures));
  return table;
}

Table transitions_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  Table table("Table 5: difference of the transition matrices from the original ones, L1",
              columns(first_column(options), {"windows", "baseline", "unseen"}, options));
  std::vector<int> digits(4 + options.scheme.size(), 2);
  digits[0] = digits[1] = -1;
  table.digits(digits);
  for (const ClassReport& one : evaluation.classes) {
    std::vector<Json> row = {one.name, one.original.windows, one.original.baseline,
                             one.unseen.transitions};
    for (const QuantisedResult& quantised : one.quantised) row.push_back(quantised.transitions);
    table.row(std::move(row));
  }
  table.note("baseline: uniform transitions; windows of " + std::to_string(options.window) +
             " frames every " + std::to_string(options.step));
  return table;
}

Table difference_table(const Evaluation& evaluation) {
  Table table("How simulated motions differ from unseen ones",
              {first_column(evaluation.options), "scheme", "d1", "d2", "p", "statistic", "spread",
               "nearest", "roughness", "log L fit", "log L unseen", "log L sim", "gap", "normal",
               "least normal", "diverged"});
  table.digits({-1, -1, -1, -1, 3, 4, 3, 3, 3, 3, 3, 3, 3, 3, 3, -1});
  const auto median = [](const std::vector<double>& values) {
    return values.empty() ? Json(nullptr) : number_or_null(median_of(values));
  };
  for (const ClassReport& one : evaluation.classes) {
    table.row({one.name, "real", nullptr, nullptr, one.real.p, one.real.statistic,
               number_or_null(one.real_spread), 1, number_or_null(one.real_roughness), nullptr,
               nullptr, nullptr, nullptr, nullptr, nullptr, nullptr});
    for (const SchemeResult& scheme : one.schemes)
      table.row({one.name, scheme.scheme, scheme.d1, scheme.d2, scheme.unseen.p,
                 scheme.unseen.statistic, number_or_null(scheme.spread),
                 number_or_null(scheme.nearest), number_or_null(scheme.roughness),
                 median(scheme.likelihood_fit), median(scheme.likelihood_test),
                 median(scheme.likelihood_samples), scheme.likelihood_gap, scheme.normal_median,
                 scheme.normal_least, scheme.diverged});
  }
  table.note(
      "by the unseen clips' own: spread, the mean distance within the sample; nearest, the "
      "median distance to the nearest clip fitted to; roughness, the mean step");
  table.note(
      "log L: median log-likelihood by coefficient; gap: Kolmogorov and Smirnov's, of the "
      "simulated from the unseen ones'");
  table.note(
      "normal, least normal: median and smallest correlation of the coefficients' normal "
      "plots");
  return table;
}

}  // namespace

std::vector<Table> evaluation_tables(const Evaluation& evaluation) {
  std::vector<Table> tables = {errors_table(evaluation), p_table(evaluation)};
  if (evaluation.options.splits > 1) tables.push_back(splits_table(evaluation));
  tables.push_back(fitted_table(evaluation));
  if (evaluation.options.level_one > 0) tables.push_back(two_level_table(evaluation));
  tables.push_back(variability_table(evaluation));
  tables.push_back(transitions_table(evaluation));
  tables.push_back(difference_table(evaluation));
  return tables;
}

}  // namespace mocaplm
