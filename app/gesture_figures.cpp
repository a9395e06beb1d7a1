#include "app/gesture_figures.h"

#include <algorithm>
#include <cmath>

#include "viewer/report_page.h"

namespace mocaplm {

namespace {

constexpr const char* kGrey = "#c4c4c4";

Eigen::VectorXd times(double duration, Eigen::Index samples) {
  return Eigen::VectorXd::LinSpaced(samples, 0, duration);
}

// The first two coordinates, or the first over time: all movements, measured and generated.
Plot overview(const PhaseModel& model, const PhaseData& data) {
  const bool plane = model.dimensions() > 1;
  Plot plot{"Phase " + model.name + ": measured and generated from the same boundaries",
            plane ? model.coordinates[0] : "s",
            plane ? model.coordinates[1] : model.coordinates[0],
            false,
            false,
            {}};
  const std::size_t shown = std::min<std::size_t>(15, data.movements.size());
  for (const bool generated : {false, true})
    for (std::size_t i = 0; i < shown; ++i) {
      Eigen::MatrixXd values = data.movements[i];
      const Boundary& boundary = data.boundaries[i];
      if (generated) MovementWriter(model, values.rows()).write(boundary, values);
      const Eigen::VectorXd x =
          plane ? Eigen::VectorXd(values.col(0)) : times(boundary.duration, values.rows());
      plot.series.push_back(line_series(i > 0       ? ""
                                        : generated ? "generated"
                                                    : "measured",
                                        x, values.col(plane ? 1 : 0), generated ? "#0072b2" : kGrey,
                                        50));
    }
  return plot;
}

// A demonstration whose error is the median.
std::size_t typical(const PhaseModel& model, const PhaseData& data) {
  std::vector<std::pair<double, std::size_t>> errors;
  for (std::size_t i = 0; i < data.movements.size(); ++i) {
    Eigen::MatrixXd values = data.movements[i];
    MovementWriter(model, values.rows()).write(data.boundaries[i], values);
    errors.emplace_back((values - data.movements[i]).norm(), i);
  }
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2].second;
}

Plot with_interval(const PhaseModel& model, const PhaseData& data, std::size_t i, Eigen::Index v) {
  const Boundary& boundary = data.boundaries[i];
  const Eigen::Index samples = data.movements[i].rows();
  Eigen::MatrixXd values(samples, model.dimensions());
  MovementWriter(model, samples).write(boundary, values);
  const Eigen::VectorXd half = model.interval(boundary, samples).col(v), middle = values.col(v);
  const Eigen::VectorXd time = times(boundary.duration, samples);
  Plot plot{"Phase " + model.name + ", " + model.coordinates[static_cast<std::size_t>(v)] +
                ": demonstration " + model.demonstration_names[i],
            "s",
            model.coordinates[static_cast<std::size_t>(v)],
            false,
            false,
            {}};
  plot.series.push_back(line_series("95% interval", time, middle + half, kGrey, 60));
  plot.series.push_back(line_series("", time, middle - half, kGrey, 60));
  plot.series.push_back(line_series("measured", time, data.movements[i].col(v), "#d55e00", 60));
  plot.series.push_back(line_series("generated", time, middle, "#0072b2", 60));
  return plot;
}

// The sine whose coefficient the conditions explain most of.
Plot hyperplane(const PhaseModel& model, const PhaseData& data) {
  const Eigen::Index m = model.size(), k = model.n_conditions();
  const Eigen::MatrixXd predicted =
      (data.q * model.f.leftCols(k).transpose()).rowwise() + model.f.col(k).transpose();
  Eigen::Index best = 2;
  double most = -1;
  for (Eigen::Index j = 0; j < data.p.cols(); ++j) {
    if (j % m < 2) continue;
    const double mean = data.p.col(j).mean();
    const double total = (data.p.col(j).array() - mean).square().sum();
    const double left = (data.p.col(j) - predicted.col(j)).squaredNorm();
    if (total - left > most) {
      most = total - left;
      best = j;
    }
  }
  const std::string name = model.coordinates[static_cast<std::size_t>(best / m)] + " sin " +
                           std::to_string(best % m - 1) + " pi tau";
  Plot plot{"Phase " + model.name + ": coefficient of " + name,
            "on the hyperplane, F [Q; 1]",
            "of the demonstration, P",
            false,
            false,
            {}};
  PlotSeries points{"", {}, false};
  for (Eigen::Index i = 0; i < data.p.rows(); ++i)
    points.points.push_back({predicted(i, best), data.p(i, best),
                             model.demonstration_names[static_cast<std::size_t>(i)]});
  const double low = predicted.col(best).minCoeff(), high = predicted.col(best).maxCoeff();
  plot.series.push_back(
      line_series("", Eigen::Vector2d(low, high), Eigen::Vector2d(low, high), kGrey));
  plot.series.push_back(points);
  return plot;
}

}  // namespace

void write_figures(const std::filesystem::path& path, const std::string& title,
                   const std::vector<Plot>& plots, const std::vector<Table>& tables) {
  ReportPage page;
  page.title = title;
  page.pictures_first = true;
  page.tables = tables;
  page.chapters.resize(1);
  for (const Plot& plot : plots) page.chapters[0].pictures.push_back(plot_svg(plot));
  write_report_page(path, page);
}

PlotSeries line_series(const std::string& name, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                       const std::string& colour, Eigen::Index most) {
  PlotSeries series{name, {}, true, false, colour};
  const Eigen::Index n = x.size(), count = std::min(n, most);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = count > 1 ? i * (n - 1) / (count - 1) : 0;
    series.points.push_back({x(at), y(at), ""});
  }
  return series;
}

std::vector<Plot> phase_plots(const PhaseModel& model, const PhaseData& data) {
  std::vector<Plot> plots = {overview(model, data)};
  const std::size_t one = typical(model, data);
  for (Eigen::Index v = 0; v < model.dimensions(); ++v)
    plots.push_back(with_interval(model, data, one, v));
  plots.push_back(hyperplane(model, data));
  return plots;
}

std::vector<Plot> juggle_plots(const JuggleRun& run) {
  Plot plane{"The first cycles", "x, m", "y, m", false, false, {}};
  Plot height{"Heights", "s", "y, m", false, false, {}};
  const auto n = static_cast<Eigen::Index>(run.first.size());
  Eigen::VectorXd time(n), hand(n), ball(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const JuggleSample& sample = run.first[static_cast<std::size_t>(i)];
    time(i) = sample.time;
    hand(i) = sample.hand.y();
    ball(i) = sample.ball.y();
  }
  height.series.push_back(line_series("hand", time, hand, "#0072b2", 600));
  height.series.push_back(line_series("ball", time, ball, "#d55e00", 600));
  const std::vector<std::string> colours = {"#0072b2", "#009e73", "#cc79a7", "#e69f00"};
  std::vector<bool> named(run.phases.size() + 1);
  for (std::size_t from = 0, to; from < run.first.size(); from = to) {
    // A stretch of one phase, and within it of the ball in the air.
    for (to = from; to < run.first.size() && run.first[to].phase == run.first[from].phase;) ++to;
    const std::size_t phase = run.first[from].phase;
    std::vector<double> x, y, bx, by;
    for (std::size_t i = from; i < std::min(to + 1, run.first.size()); ++i) {
      x.push_back(run.first[i].hand.x());
      y.push_back(run.first[i].hand.y());
      if (run.first[i].held) continue;
      bx.push_back(run.first[i].ball.x());
      by.push_back(run.first[i].ball.y());
    }
    const auto vector = [](const std::vector<double>& values) {
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
          values.data(), static_cast<Eigen::Index>(values.size())));
    };
    plane.series.push_back(line_series(named[phase] ? "" : run.phases[phase].name, vector(x),
                                       vector(y), colours[phase % colours.size()], 40));
    named[phase] = true;
    if (bx.size() > 1) {
      plane.series.push_back(
          line_series(named.back() ? "" : "ball", vector(bx), vector(by), "#d55e00", 40));
      named.back() = true;
    }
  }
  return {plane, height};
}

}  // namespace mocaplm
