#include "viewer/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/error.h"
#include "common/text.h"
#include "viewer/html.h"

namespace mocaplm {

namespace {

constexpr double kWidth = 760, kTop = 56, kLetter = 6.6;
// Okabe and Ito 2008, the last method's (usually the model's own) first.
constexpr const char* kColours[] = {"#0072b2", "#e69f00", "#9aa0ac", "#009e73", "#cc79a7"};

std::string number(double value) {
  return format_number(std::round(value * 100) / 100);
}

std::string text_tag(double x, double y, const std::string& anchor, const std::string& text,
                     const std::string& more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" +
         (more.empty() ? "" : " " + more) + ">" + escape_html(text) + "</text>\n";
}

// A rectangle that tells its numbers.
std::string told_rect(double x, double y, double width, double height, const std::string& more,
                      const std::string& tip) {
  const std::string text = escape_html(tip);
  return "<rect x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) +
         "\" height=\"" + number(height) + "\" " + more + " data-tip=\"" + text + "\"><title>" +
         text + "</title></rect>\n";
}

std::string opened(const std::string& title, double height) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(kWidth) + " " +
         number(height) +
         "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\" role=\"img\">\n<title>" +
         escape_html(title) +
         "</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         text_tag(kWidth / 2, 24, "middle", title, "font-size=\"16\"");
}

double longest(const std::vector<std::string>& names, std::size_t at_most) {
  std::size_t most = 0;
  for (const std::string& name : names) most = std::max(most, name.size());
  return kLetter * static_cast<double>(std::min(most, at_most));
}

std::string cut(const std::string& name, std::size_t at_most) {
  return name.size() <= at_most ? name : name.substr(0, at_most - 2) + "..";
}

std::string percent(double value) {
  return format_fixed(value, 1) + " %";
}

const char* colour(std::size_t method, std::size_t methods) {
  return kColours[(methods - 1 - method) % std::size(kColours)];
}

std::string legend(const std::vector<std::string>& names, double left) {
  std::string svg;
  for (std::size_t m = 0; m < names.size(); ++m) {
    svg += "<rect x=\"" + number(left) + "\" y=\"36\" width=\"11\" height=\"11\" rx=\"2\" fill=\"" +
           colour(m, names.size()) + "\"/>\n" + text_tag(left + 17, 46, "start", names[m]);
    left += 42 + kLetter * static_cast<double>(names[m].size());
  }
  return svg;
}

}  // namespace

std::string bars_svg(const BarChart& chart) {
  if (chart.rows.empty()) throw UsageError("there is nothing to plot: no bars");
  std::vector<std::string> names;
  for (const BarChart::Row& row : chart.rows) {
    names.push_back(row.name);
    if (row.percent.size() != chart.methods.size())
      throw UsageError("\"" + row.name + "\" has " + std::to_string(row.percent.size()) +
                       " bars, expected " + std::to_string(chart.methods.size()));
  }
  const double bar = chart.methods.size() > 1 ? 9 : 15;
  const double high = bar * static_cast<double>(chart.methods.size()) + 12;
  const double left = 28 + longest(names, 24), right = kWidth - 62;
  const double bottom = kTop + 8 + high * static_cast<double>(chart.rows.size());
  std::string svg = opened(chart.title, bottom + 28) + legend(chart.methods, left);
  for (const int tick : {0, 25, 50, 75, 100}) {
    const double x = left + (right - left) * tick / 100;
    svg += "<line x1=\"" + number(x) + "\" y1=\"" + number(kTop) + "\" x2=\"" + number(x) +
           "\" y2=\"" + number(bottom) + "\" class=\"grid\" stroke=\"#e3e3e3\"/>\n" +
           text_tag(x, bottom + 17, "middle", std::to_string(tick) + " %");
  }
  double y = kTop + 10;
  for (const BarChart::Row& row : chart.rows) {
    svg += text_tag(left - 10, y + (high - 12) / 2 + 4, "end", cut(row.name, 24));
    for (std::size_t m = 0; m < row.percent.size(); ++m, y += bar) {
      if (!std::isfinite(row.percent[m])) continue;
      const double wide = std::max((right - left) * row.percent[m] / 100, 1.5);
      svg += told_rect(left, y, wide, bar - 1.5,
                       "rx=\"2\" fill=\"" + std::string(colour(m, row.percent.size())) + "\"",
                       row.name + "\n" + chart.methods[m] + ": " + percent(row.percent[m]) +
                           (row.note.empty() ? "" : "\n" + row.note));
      if (m + 1 == row.percent.size())
        svg += text_tag(left + wide + 6, y + bar - 1, "start", percent(row.percent[m]));
    }
    y += 12;
  }
  return svg + "</svg>\n";
}

std::string matrix_svg(const MatrixChart& chart) {
  const std::size_t classes = chart.classes.size();
  bool square = chart.counts.size() == classes;
  for (const auto& row : chart.counts) square = square && row.size() == classes;
  if (classes == 0 || !square)
    throw UsageError("a matrix of " + std::to_string(classes) + " classes needs as many rows and " +
                     "columns of counts");
  const double names = longest(chart.classes, 18), left = 58 + names;
  const double cell = std::clamp((kWidth - left - 60) / static_cast<double>(classes), 8.0, 58.0);
  const double top = 62 + 0.75 * names, side = cell * static_cast<double>(classes);
  std::string svg = opened(chart.title, top + side + 20);
  svg += text_tag(20, top + side / 2, "middle", "true",
                  "transform=\"rotate(-90 20 " + number(top + side / 2) + ")\"");
  svg += text_tag(left - 12, 48, "end", "predicted");
  for (std::size_t r = 0; r < classes; ++r) {
    const double y = top + cell * static_cast<double>(r), x = left + cell * static_cast<double>(r);
    if (cell >= 11 || classes < 2) {
      svg += text_tag(left - 10, y + cell / 2 + 4, "end", cut(chart.classes[r], 18));
      const std::string place = number(x + cell / 2) + " " + number(top - 8);
      svg += text_tag(x + cell / 2, top - 8, "start", cut(chart.classes[r], 18),
                      "transform=\"rotate(-45 " + place + ")\"");
    }
    long sum = 0;
    for (const long count : chart.counts[r]) sum += count;
    for (std::size_t c = 0; c < classes; ++c) {
      const long count = chart.counts[r][c];
      const double share = sum > 0 ? static_cast<double>(count) / static_cast<double>(sum) : 0;
      const double at = left + cell * static_cast<double>(c);
      const std::string fill = r == c ? "#0072b2" : "#d55e00";
      svg += told_rect(at, y, cell - 1, cell - 1,
                       "rx=\"2\" class=\"field\" fill=\"" + fill + "\" fill-opacity=\"" +
                           number(0.06 + 0.9 * share) + "\"",
                       chart.classes[r] + (r == c ? ", found" : ", taken for " + chart.classes[c]) +
                           ": " + std::to_string(count) + " of " + std::to_string(sum) + " (" +
                           percent(100 * share) + ")");
      if (count > 0 && cell >= 16)
        svg += text_tag(at + cell / 2 - 0.5, y + cell / 2 + 4, "middle", std::to_string(count),
                        share > 0.45 ? "class=\"on\" fill=\"#fff\"" : "");
    }
  }
  return svg + "</svg>\n";
}

}  // namespace mocaplm
