#include "viewer/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "common/error.h"
#include "common/text.h"
#include "viewer/html.h"

namespace mocaplm {

namespace {

constexpr double kWidth = 760, kHeight = 460;
constexpr double kLeft = 72, kRight = 20, kTop = 44, kBottom = 56;
// Okabe and Ito 2008: told apart by most people.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#000000"};

std::string number(double value) {
  return format_number(std::round(value * 100) / 100);
}

// Four digits are enough to read.
std::string shown(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
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

std::string text_tag(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\" " +
         more + ">" + escape_html(text) + "</text>\n";
}

std::string axes_tags(const Plot& plot, const Axis& x, const Axis& y) {
  std::string svg;
  for (const double tick : plot_ticks(x.low, x.high, x.log)) {
    svg += line_tag(x.at(tick), y.from, x.at(tick), y.to, "class=\"grid\" stroke=\"#e3e3e3\"");
    svg += text_tag(x.at(tick), y.from + 18, "middle", shown(tick));
  }
  for (const double tick : plot_ticks(y.low, y.high, y.log)) {
    svg += line_tag(x.from, y.at(tick), x.to, y.at(tick), "class=\"grid\" stroke=\"#e3e3e3\"");
    svg += text_tag(x.from - 8, y.at(tick) + 4, "end", shown(tick));
  }
  svg += line_tag(x.from, y.from, x.to, y.from, "class=\"axis\" stroke=\"#333\"");
  svg += line_tag(x.from, y.from, x.from, y.to, "class=\"axis\" stroke=\"#333\"");
  svg += text_tag((x.from + x.to) / 2, kHeight - 14, "middle", plot.x_label);
  const std::string middle = number((y.from + y.to) / 2);
  svg += text_tag(18, (y.from + y.to) / 2, "middle", plot.y_label,
                  "transform=\"rotate(-90 18 " + middle + ")\"");
  svg += text_tag((x.from + x.to) / 2, 24, "middle", plot.title, "font-size=\"16\"");
  return svg;
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
  x.from = kLeft;
  // The legend stands beside the picture, so that it hides nothing.
  std::size_t longest = 0;
  for (const PlotSeries& series : plot.series) longest = std::max(longest, series.name.size());
  x.to = kWidth - kRight - (longest > 0 ? 24 + 6.6 * static_cast<double>(longest) : 0);
  y.from = kHeight - kBottom;
  y.to = kTop;

  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kWidth) +
                    " " + number(kHeight) +
                    "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\" role=\"img\">\n"
                    "<title>" +
                    escape_html(plot.title) +
                    "</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" "
                    "fill=\"#fff\"/>\n";
  svg += axes_tags(plot, x, y);
  std::size_t colour = 0;
  double legend = kTop + 14;
  for (const PlotSeries& series : plot.series) {
    const std::string ink = series.colour.empty() ? kColours[colour++ % std::size(kColours)]
                                                  : escape_html(series.colour);
    svg += series_tags(plot, series, ink, x, y);
    if (series.name.empty()) continue;
    svg += "<circle cx=\"" + number(x.to + 18) + "\" cy=\"" + number(legend - 4) +
           "\" r=\"4\" fill=\"" + ink + "\"/>\n";
    svg += text_tag(x.to + 28, legend, "start", series.name);
    legend += 17;
  }
  return svg + "</svg>\n";
}

}  // namespace mocaplm
