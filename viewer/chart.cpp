#include "viewer/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/error.h"
#include "common/text.h"
#include "viewer/html.h"
#include "viewer/svg.h"

namespace mocaplm {

namespace {

using svg::number;

constexpr double kChartWidth = 560;
// Of a name beside a picture; the whole one comes with the numbers.
constexpr std::size_t kBarName = 18, kFieldName = 16;
// Okabe and Ito 2008, the last method's (usually the model's own) first.
constexpr const char* kMethodColours[] = {"#0072b2", "#e69f00", "#9aa0ac", "#009e73", "#cc79a7"};

// A rectangle that tells its numbers.
std::string told_rect(double x, double y, double width, double height, const std::string& more,
                      const std::string& tip) {
  const std::string text = escape_html(tip);
  return "<rect x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) +
         "\" height=\"" + number(height) + "\" " + more + " data-tip=\"" + text + "\"><title>" +
         text + "</title></rect>\n";
}

double longest(const std::vector<std::string>& names, std::size_t at_most) {
  std::size_t most = 0;
  for (const std::string& name : names) most = std::max(most, name.size());
  return svg::width(std::min(most, at_most));
}

std::string percent(double value) {
  return format_fixed(value, 1) + " %";
}

const char* colour(std::size_t method, std::size_t methods) {
  return kMethodColours[(methods - 1 - method) % std::size(kMethodColours)];
}

std::string legend(const std::vector<std::string>& names) {
  std::string tags;
  double left = 30;
  for (std::size_t m = 0; m < names.size(); ++m) {
    tags += "<rect x=\"" + number(left) +
            "\" y=\"36\" width=\"11\" height=\"11\" rx=\"2\" fill=\"" + colour(m, names.size()) +
            "\"/>\n" + svg::text(left + 17, 46, "start", names[m]);
    left += 40 + svg::width(names[m].size());
  }
  return tags;
}

void check_bars(const BarChart& chart) {
  if (chart.rows.empty()) throw UsageError("there is nothing to plot: no bars");
  for (const BarChart::Row& row : chart.rows)
    if (row.percent.size() != chart.methods.size())
      throw UsageError("\"" + row.name + "\" has " + std::to_string(row.percent.size()) +
                       " bars, expected " + std::to_string(chart.methods.size()));
}

// The bars of one class, from `y` down, each `high` with its gap.
std::string row_tags(const BarChart& chart, const BarChart::Row& row, double left, double right,
                     double y, double high) {
  const std::size_t methods = chart.methods.size();
  std::string tags;
  for (std::size_t m = 0; m < methods; ++m, y += high) {
    if (!std::isfinite(row.percent[m])) continue;
    const double wide = std::max((right - left) * row.percent[m] / 100, 1.5);
    tags += told_rect(left, y, wide, high - 1.5,
                      "rx=\"2\" fill=\"" + std::string(colour(m, methods)) + "\"",
                      row.name + "\n" + chart.methods[m] + ": " + percent(row.percent[m]) +
                          (row.note.empty() ? "" : "\n" + row.note));
    if (m + 1 == methods)
      tags += svg::text(left + wide + 6, y + high / 2 + 3.5, "start", percent(row.percent[m]));
  }
  return tags;
}

// Row and column names of a matrix, at the place of class `c`.
std::string class_tags(const std::string& name, double left, double top, double at, double cell) {
  const std::string shown = svg::cut(name, kFieldName);
  const std::string place = number(left + at + cell / 2 + 3) + " " + number(top - 8);
  return svg::text(left - 8, top + at + cell / 2 + 4, "end", shown) +
         svg::text(left + at + cell / 2 + 3, top - 8, "start", shown,
                   "transform=\"rotate(-45 " + place + ")\"");
}

// The field of true class `r` and predicted class `c`.
std::string field_tags(const MatrixChart& chart, std::size_t r, std::size_t c, double x, double y,
                       double cell) {
  const double side = cell - std::min(1.0, 0.1 * cell);
  long sum = 0;
  for (const long count : chart.counts[r]) sum += count;
  const long count = chart.counts[r][c];
  const double share = sum > 0 ? static_cast<double>(count) / static_cast<double>(sum) : 0;
  const std::string fill = r == c ? "#0072b2" : "#d55e00";
  std::string tags = told_rect(
      x, y, side, side,
      "rx=\"2\" class=\"field\" fill=\"" + fill + "\" fill-opacity=\"" +
          number(0.06 + 0.9 * share) + "\"",
      chart.classes[r] + (r == c ? ", found" : ", taken for " + chart.classes[c]) + ": " +
          std::to_string(count) + " of " + std::to_string(sum) + " (" + percent(100 * share) + ")");
  const std::string shown = std::to_string(count);
  if (count > 0 && cell > svg::width(shown.size()))
    tags += svg::text(x + side / 2, y + side / 2 + 4, "middle", shown,
                      share > 0.45 ? "class=\"on\" fill=\"#fff\"" : "");
  return tags;
}

}  // namespace

std::string bars_svg(const BarChart& chart) {
  check_bars(chart);
  std::vector<std::string> names;
  for (const BarChart::Row& row : chart.rows) names.push_back(row.name);
  const double bar = chart.methods.size() > 1 ? 9 : 15, top = 58;
  const double high = bar * static_cast<double>(chart.methods.size()) + 13;
  const double left = 18 + longest(names, kBarName), right = kChartWidth - 80;
  const double bottom = top + 8 + high * static_cast<double>(chart.rows.size());
  std::string tags = svg::open(kChartWidth, bottom + 30, chart.title) + legend(chart.methods);
  for (const int tick : {0, 25, 50, 75, 100}) {
    const double x = left + (right - left) * tick / 100;
    tags += "<line x1=\"" + number(x) + "\" y1=\"" + number(top) + "\" x2=\"" + number(x) +
            "\" y2=\"" + number(bottom) + "\" class=\"grid\" stroke=\"#e3e3e3\"/>\n" +
            svg::text(x, bottom + 19, "middle", std::to_string(tick) + " %");
  }
  double y = top + 10;
  for (const BarChart::Row& row : chart.rows) {
    tags += svg::text(left - 10, y + (high - 13) / 2 + 3.5, "end", svg::cut(row.name, kBarName));
    tags += row_tags(chart, row, left, right, y, bar);
    y += high;
  }
  return tags + "</svg>\n";
}

std::string matrix_svg(const MatrixChart& chart) {
  const std::size_t classes = chart.classes.size();
  bool square = chart.counts.size() == classes;
  for (const auto& row : chart.counts) square = square && row.size() == classes;
  if (classes == 0 || !square)
    throw UsageError("a matrix of " + std::to_string(classes) + " classes needs as many rows and " +
                     "columns of counts");
  // The last column's name leans over the right edge.
  const double names = longest(chart.classes, kFieldName), left = 44 + names;
  const double room = kChartWidth - left - std::max(0.7 * names, 24.0);
  const double cell = std::min(room / static_cast<double>(classes), 52.0);
  const double top = 58 + 0.75 * names, side = cell * static_cast<double>(classes);
  std::string tags = svg::open(kChartWidth, top + side + 18, chart.title);
  tags += svg::text(20, top + side / 2, "middle", "true",
                    "transform=\"rotate(-90 20 " + number(top + side / 2) + ")\"");
  tags += svg::text(left - 12, top - 14, "end", "predicted");
  for (std::size_t r = 0; r < classes; ++r) {
    const double y = cell * static_cast<double>(r);
    if (cell >= 15) tags += class_tags(chart.classes[r], left, top, y, cell);
    for (std::size_t c = 0; c < classes; ++c)
      tags += field_tags(chart, r, c, left + cell * static_cast<double>(c), top + y, cell);
  }
  return tags + "</svg>\n";
}

}  // namespace mocaplm
