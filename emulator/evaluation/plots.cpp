#include "emulator/evaluation/plots.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "common/files.h"
#include "numeric/quantiles.h"
#include "numeric/scaling.h"
#include "viewer/report_page.h"

namespace mocaplm {

namespace {

using Eigen::Index;

// Simulated and unseen motions, and those fitted to, in one plane.
Plot scaling_plot(const ClassReport& one, const SchemeResult& scheme) {
  const Eigen::MatrixXd real = joined_distances(one.test_distances, one.fit_distances, one.cross);
  Eigen::MatrixXd between(scheme.to_test.rows(), real.cols());
  between << scheme.to_test, scheme.to_fit;
  const Scaling scaling =
      classical_scaling(joined_distances(scheme.sample_distances, real, between), 2);
  Plot plot;
  plot.title = one.name + ", " + scheme.scheme;
  plot.x_label = "first axis";
  plot.y_label = "second axis";
  plot.series.resize(3);
  const char* names[] = {"fitted to", "unseen", "simulated"};
  for (std::size_t k = 0; k < 3; ++k) {
    plot.series[k].name = names[k];
    plot.series[k].line = false;
  }
  const Index samples = between.rows(), tests = one.test_distances.rows();
  for (Index i = 0; i < scaling.points.rows(); ++i) {
    const std::size_t series = i < samples ? 2 : i < samples + tests ? 1 : 0;
    plot.series[series].points.push_back({scaling.points(i, 0), scaling.points(i, 1), ""});
  }
  return plot;
}

PlotSeries steps_series(const std::string& name, const Eigen::VectorXd& steps) {
  PlotSeries series{name, {}, true};
  for (Index t = 0; t < steps.size(); ++t)
    series.points.push_back({static_cast<double>(t), steps[t], ""});
  return series;
}

Plot steps_plot(const ClassReport& one) {
  Plot plot;
  plot.title = one.name + ": distance from frame to frame";
  plot.x_label = "frame";
  plot.y_label = "radians over all limbs";
  plot.log_y = true;
  plot.series = {steps_series("fitted to", one.fit_steps), steps_series("unseen", one.test_steps)};
  for (const SchemeResult& scheme : one.schemes)
    plot.series.push_back(steps_series(scheme.scheme, scheme.steps));
  return plot;
}

PlotSeries quantile_series(const std::string& name, const std::vector<double>& unseen,
                           const std::vector<double>& samples, double& low, double& high) {
  PlotSeries series{name, {}, false};
  if (unseen.empty() || samples.empty()) return series;
  for (const auto& [x, y] : compare_quantiles(unseen, samples, 40).points) {
    series.points.push_back({x, y, ""});
    if (std::isfinite(x)) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  return series;
}

Plot quantile_plot(const std::string& title, std::vector<PlotSeries> series, double low,
                   double high) {
  Plot plot;
  plot.title = title;
  plot.x_label = "log-likelihood a coefficient, unseen";
  plot.y_label = "the same, simulated";
  plot.series = {{"identity", {{low, low, ""}, {high, high, ""}}, true}};
  // A model far off would leave nothing to see of the others.
  const double floor = low - 2 * (high - low);
  for (PlotSeries& one : series) {
    one.points.erase(std::remove_if(one.points.begin(), one.points.end(),
                                    [&](const PlotPoint& p) { return !(p.y >= floor); }),
                     one.points.end());
    plot.series.push_back(std::move(one));
  }
  return plot;
}

Plot likelihood_plot(const ClassReport& one) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  std::vector<PlotSeries> series;
  for (const SchemeResult& scheme : one.schemes)
    series.push_back(quantile_series(scheme.scheme, scheme.likelihood_test,
                                     scheme.likelihood_samples, low, high));
  return quantile_plot(one.name + ": quantiles of the log-likelihood", std::move(series), low,
                       high);
}

Plot two_level_plot(const ClassReport& one, const std::string& level_one) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  std::vector<PlotSeries> series;
  for (const TwoLevelResult& result : one.two_level)
    if (result.level_one == level_one)
      series.push_back(quantile_series(result.level_two, result.likelihood_test,
                                       result.likelihood_samples, low, high));
  return quantile_plot(one.name + ": level one " + level_one, std::move(series), low, high);
}

Plot reconstruction_plot(const ClassReport& one, const ReconstructionCurve& curve, bool p_values) {
  Plot plot;
  plot.title =
      one.name + ", " + curve.representation +
      (p_values ? ": unseen clips against their reconstructions" : ": reconstruction error");
  plot.x_label = "d2";
  plot.y_label = p_values ? "p" : "radians over all limbs";
  for (const ReconstructionPoint& point : curve.points) {
    const std::string name = "d1 = " + std::to_string(point.d1);
    if (plot.series.empty() || plot.series.back().name != name)
      plot.series.push_back({name, {}, true});
    plot.series.back().points.push_back(
        {static_cast<double>(point.d2), p_values ? point.p : point.unseen, ""});
  }
  return plot;
}

Plot clusters_plot(const PostureClusters& clusters) {
  Plot plot;
  plot.title = "Posture clusters: modes found for each neighbourhood";
  plot.x_label = "epsilon, radians over all limbs";
  plot.y_label = "modes";
  plot.log_y = true;
  PlotSeries tried{"tried", {}, true}, chosen{"chosen", {}, false};
  for (const ModeTrial& trial : clusters.trials) {
    if (trial.modes < 1) continue;
    const std::string label = "F " + std::to_string(trial.ratio);
    tried.points.push_back({trial.epsilon, static_cast<double>(trial.modes), label});
    if (trial.modes == clusters.count())
      chosen.points.push_back({trial.epsilon, static_cast<double>(trial.modes), label});
  }
  plot.series = {std::move(tried), std::move(chosen)};
  return plot;
}

Table settings_table(const EvaluationOptions& options) {
  Table table("Settings", {"setting", "value"});
  const Json settings = evaluation_settings(options);
  for (const auto& item : settings.items())
    table.row({item.key(),
               item.value().is_string() ? item.value().get<std::string>() : item.value().dump()});
  return table;
}

bool has_points(const Plot& plot) {
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (std::isfinite(point.x) && std::isfinite(point.y) && (!plot.log_y || point.y > 0))
        return true;
  return false;
}

void class_plots(const ClassReport& one, std::vector<NamedPlot>& plots) {
  const std::string stem = file_stem(one.name);
  const auto add = [&](const std::string& name, Plot plot) {
    if (has_points(plot)) plots.push_back({stem + "-" + name, one.name, std::move(plot)});
  };
  for (const SchemeResult& scheme : one.schemes)
    if (scheme.sample_distances.size() > 0)
      add("scaling-" + file_stem(scheme.scheme), scaling_plot(one, scheme));
  add("steps", steps_plot(one));
  add("likelihood", likelihood_plot(one));
  for (const ReconstructionCurve& curve : one.curves) {
    add("reconstruction", reconstruction_plot(one, curve, false));
    add("reconstruction-p", reconstruction_plot(one, curve, true));
  }
  std::string last;
  for (const TwoLevelResult& result : one.two_level) {
    if (result.level_one != last)
      add("two-level-" + file_stem(result.level_one), two_level_plot(one, result.level_one));
    last = result.level_one;
  }
}

}  // namespace

std::string file_stem(const std::string& text) {
  std::string stem;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    if (plain)
      stem += c;
    else if (!stem.empty() && stem.back() != '-')
      stem += '-';
  }
  while (!stem.empty() && stem.back() == '-') stem.pop_back();
  return stem.empty() ? "plot" : stem;
}

std::vector<NamedPlot> evaluation_plots(const Evaluation& evaluation) {
  std::vector<NamedPlot> plots;
  if (evaluation.clusters.trials.size() > 1)
    plots.push_back({"posture-clusters", "", clusters_plot(evaluation.clusters)});
  for (const ClassReport& one : evaluation.classes) class_plots(one, plots);
  return plots;
}

void write_report(const std::filesystem::path& out, const Evaluation& evaluation,
                  const std::vector<Table>& tables) {
  ReportPage page;
  page.title = "Emulated motions of " + evaluation.options.data.string();
  if (evaluation.procedural) page.note = "procedural dances made by this program";
  page.tables = tables;
  page.tables.push_back(settings_table(evaluation.options));
  for (const NamedPlot& one : evaluation_plots(evaluation)) {
    const std::string svg = plot_svg(one.plot);
    write_file(out / "plots" / (one.name + ".svg"), svg, Flush::later);
    const std::string chapter = one.chapter.empty() ? "Posture clusters" : one.chapter;
    if (page.chapters.empty() || page.chapters.back().title != chapter)
      page.chapters.push_back({chapter, {}});
    page.chapters.back().pictures.push_back(svg);
  }
  write_report_page(out / "report.html", page);
  save_json(out / "settings.json", evaluation_settings(evaluation.options));
}

}  // namespace mocaplm
