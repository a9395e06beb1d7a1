#include "viewer/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "common/error.h"
#include "common/text.h"
#include "viewer/html.h"
#include "viewer/svg.h"

namespace mocaplm {

namespace {

using svg::number;

// The legend's rows come on top of the height.
constexpr double kWidth = 560, kHeight = 372;
constexpr double kLeft = 34, kRight = 18, kTop = 42, kBottom = 54, kLegendRow = 21;
constexpr int kXTicks = 7, kYTicks = 7;
// Okabe and Ito 2008: told apart by most people.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#000000"};

// Four digits are enough to read; counts up to millions are written out.
std::string shown(double value) {
  char buffer[32];
  const double size = std::abs(value);
  std::snprintf(buffer, sizeof buffer, size >= 1000 && size < 1e7 ? "%.0f" : "%.4g", value);
  return buffer;
}

// One axis: values to places in the picture.
struct Axis {
  bool log = false;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double from = 0, to = 1;

  bool shows(double value) const { return std::isfinite(value) && (!log || value > 0); }
  double scaled(double value) const { return log ? std::log10(value) : value; }
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // Room at both ends; an axis of one value gets some around it.
  void widen() {
    double a = scaled(low), b = scaled(high);
    const double margin = b > a ? 0.04 * (b - a) : log ? 0.5 : std::max(1e-9, 0.1 * std::abs(a));
    const bool from_zero = !log && low >= 0 && a - 0.3 * (b - a) < 0;
    a = from_zero ? 0 : a - margin;
    b += margin;
    low = log ? std::pow(10, a) : a;
    high = log ? std::pow(10, b) : b;
  }
  double at(double value) const {
    return from + (to - from) * (scaled(value) - scaled(low)) / (scaled(high) - scaled(low));
  }
};

std::string line_tag(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
         "\" y2=\"" + number(y2) + "\" " + style + "/>\n";
}

std::string axes_tags(const Plot& plot, const Axis& x, const Axis& y) {
  std::string tags;
  for (const double tick : plot_ticks(x.low, x.high, x.log, kXTicks)) {
    tags += line_tag(x.at(tick), y.from, x.at(tick), y.to, "class=\"grid\" stroke=\"#e3e3e3\"");
    tags += svg::text(x.at(tick), y.from + 19, "middle", shown(tick));
  }
  for (const double tick : plot_ticks(y.low, y.high, y.log, kYTicks)) {
    tags += line_tag(x.from, y.at(tick), x.to, y.at(tick), "class=\"grid\" stroke=\"#e3e3e3\"");
    tags += svg::text(x.from - 7, y.at(tick) + 4, "end", shown(tick));
  }
  tags += line_tag(x.from, y.from, x.to, y.from, "class=\"axis\" stroke=\"#333\"");
  tags += line_tag(x.from, y.from, x.from, y.to, "class=\"axis\" stroke=\"#333\"");
  tags += svg::text((x.from + x.to) / 2, y.from + 44, "middle", plot.x_label);
  const double middle = (y.from + y.to) / 2;
  tags += svg::text(17, middle, "middle", plot.y_label,
                    "transform=\"rotate(-90 17 " + number(middle) + ")\"");
  return tags;
}

// Room for the ticks' numbers, left of the axis.
double widest_tick(const Axis& y) {
  std::size_t letters = 0;
  for (const double tick : plot_ticks(y.low, y.high, y.log, kYTicks))
    letters = std::max(letters, shown(tick).size());
  return svg::width(letters);
}

std::vector<std::string> inks(const Plot& plot) {
  std::vector<std::string> found;
  std::size_t next = 0;
  for (const PlotSeries& series : plot.series)
    found.push_back(series.colour.empty() ? kColours[next++ % std::size(kColours)]
                                          : escape_html(series.colour));
  return found;
}

// Under the title, in as many rows as it needs; `rows` counts them.
std::string legend_tags(const Plot& plot, int& rows) {
  std::string tags;
  const std::vector<std::string> ink = inks(plot);
  double left = kLeft;
  rows = 0;
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const std::string& name = plot.series[s].name;
    if (name.empty()) continue;
    const double wide = 34 + svg::width(name.size());
    if (rows == 0 || left + wide > kWidth) {
      left = kLeft;
      ++rows;
    }
    const double y = kTop + kLegendRow * (rows - 1);
    tags += "<circle cx=\"" + number(left) + "\" cy=\"" + number(y) + "\" r=\"4\" fill=\"" +
            ink[s] + "\"/>\n" + svg::text(left + 10, y + 4, "start", name);
    left += wide;
  }
  return tags;
}

std::string series_tags(const Plot& plot, const PlotSeries& series, const std::string& colour,
                        const Axis& x, const Axis& y) {
  std::string path, dots;
  // Of a long line the points are for the mouse alone.
  const bool quiet = series.line && series.points.size() > 40;
  for (const PlotPoint& point : series.points) {
    if (!x.shows(point.x) || !y.shows(point.y)) continue;
    const std::string px = number(x.at(point.x)), py = number(y.at(point.y));
    path += (path.empty() ? "" : " ") + px + "," + py;
    const std::string label = (point.label.empty() ? series.name : point.label);
    const std::string tip =
        escape_html((label.empty() ? "" : label + "\n") + plot.x_label + ": " + shown(point.x) +
                    "\n" + plot.y_label + ": " + shown(point.y));
    dots += "<circle cx=\"" + px + "\" cy=\"" + py + "\" r=\"4\" fill=\"" + colour + "\"" +
            (quiet ? " fill-opacity=\"0\"" : "") + " data-tip=\"" + tip + "\"><title>" + tip +
            "</title></circle>\n";
  }
  if (!series.line) return dots;
  return "<polyline points=\"" + path + "\" fill=\"none\" stroke=\"" + colour +
         "\" stroke-width=\"2\"/>\n" + (series.dots ? dots : "");
}

}  // namespace

std::vector<double> plot_ticks(double low, double high, bool logarithmic, int most) {
  std::vector<double> ticks;
  if (logarithmic) {
    const int first = static_cast<int>(std::floor(std::log10(low)));
    const int last = static_cast<int>(std::ceil(std::log10(high)));
    // As many as fit: 1 to 9; 1, 2, 5; powers of ten, of many only every second, third, ...
    for (const std::vector<double>& steps :
         {std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}, {1, 2, 5}, {1}}) {
      const int stride = steps.size() > 1 ? 1 : (last - first) / most + 1;
      ticks.clear();
      for (int power = first; power <= last; power += stride)
        for (const double step : steps) {
          const double tick = step * std::pow(10, power);
          if (tick >= low && tick <= high) ticks.push_back(tick);
        }
      if (static_cast<int>(ticks.size()) <= most) break;
    }
    return ticks;
  }
  const double rough = (high - low) / most;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= rough) step = factor * power;
  for (double k = std::ceil(low / step); k * step <= high; ++k)
    ticks.push_back(k * step + 0.0);  // not -0
  return ticks;
}

std::string plot_svg(const Plot& plot) {
  Axis x{plot.log_x}, y{plot.log_y};
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (x.shows(point.x) && y.shows(point.y)) {
        x.include(point.x);
        y.include(point.y);
      }
  if (x.low > x.high) throw UsageError("there is nothing to plot: no finite points");
  x.widen();
  y.widen();
  int rows = 0;
  const std::string legend = legend_tags(plot, rows);
  const double height = kHeight + kLegendRow * rows;
  x.from = kLeft + widest_tick(y);
  x.to = kWidth - kRight;
  y.from = height - kBottom;
  y.to = kTop + kLegendRow * rows;

  std::string tags = svg::open(kWidth, height, plot.title) + legend + axes_tags(plot, x, y);
  const std::vector<std::string> ink = inks(plot);
  for (std::size_t s = 0; s < plot.series.size(); ++s)
    tags += series_tags(plot, plot.series[s], ink[s], x, y);
  return tags + "</svg>\n";
}

Table plot_table(const Plot& plot) {
  Table table(plot.title, {"", plot.x_label, plot.y_label});
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) {
      std::vector<std::string> names;
      for (const std::string& name : {series.name, point.label})
        if (!name.empty()) names.push_back(name);
      table.row({join(names, ": "), std::stod(shown(point.x)), std::stod(shown(point.y))});
    }
  return table;
}

}  // namespace mocaplm
