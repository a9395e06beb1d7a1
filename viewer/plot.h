// A plot as an SVG file of its own: axes with ticks, lines or points, a legend; each point tells
// its values when the mouse rests on it. No script, no font and no colour from elsewhere; it can be
// read on a light and on a dark page, for it has a background. In a page (PagePlot) it takes the
// page's colours, and its numbers come at once (assets/plot.css, plot.js).
#pragma once

#include <string>
#include <vector>

#include "common/table.h"

namespace mocaplm {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // shown beside the values, may be empty
};

struct PlotSeries {
  std::string name;  // in the legend; without one the series is not listed
  std::vector<PlotPoint> points;
  bool line = true;         // joined in the order given; else points alone
  bool dots = true;         // a dot at each point of a line
  std::string colour = "";  // as in CSS; empty: the next one of the palette
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;  // then values must be positive; others are left out
  std::vector<PlotSeries> series;
};

// Where ticks go between low and high: multiples of 1, 2 or 5 times a power of ten, at most `most`
// of them; on a logarithmic axis the powers of ten, with their multiples or their doubles and
// fives where there is room. low < high.
std::vector<double> plot_ticks(double low, double high, bool logarithmic, int most = 8);

// The whole file's text. Points that are not finite are left out. Throws UsageError when none is
// left.
std::string plot_svg(const Plot& plot);

// The numbers of all points, a row each, by their labels or their series' names.
Table plot_table(const Plot& plot);

}  // namespace mocaplm
