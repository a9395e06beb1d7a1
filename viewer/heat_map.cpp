#include "viewer/heat_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/error.h"
#include "viewer/plot.h"
#include "viewer/svg.h"

namespace mocaplm {

namespace {

using svg::number;

constexpr double kPanel = 260, kPanelHeight = 220, kPanelLeft = 64, kGap = 24, kPanelTop = 64,
                 kPanelBottom = 52;
constexpr Eigen::Index kMostColumns = 400;
// Viridis (van der Walt and Smith 2015) at 0, 1/4, ... 1.
constexpr double kViridis[5][3] = {
    {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};

std::string colour(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * 4;
  const int low = std::min(static_cast<int>(place), 3);
  char text[8];
  int mixed[3];
  for (int i = 0; i < 3; ++i)
    mixed[i] = static_cast<int>(
        std::lround(kViridis[low][i] + (place - low) * (kViridis[low + 1][i] - kViridis[low][i])));
  std::snprintf(text, sizeof text, "#%02x%02x%02x", mixed[0] & 255, mixed[1] & 255, mixed[2] & 255);
  return text;
}

Eigen::MatrixXd few_columns(const Eigen::MatrixXd& values) {
  if (values.cols() <= kMostColumns) return values;
  const Eigen::Index every = (values.cols() + kMostColumns - 1) / kMostColumns;
  Eigen::MatrixXd out(values.rows(), (values.cols() + every - 1) / every);
  for (Eigen::Index c = 0; c < out.cols(); ++c)
    out.col(c) =
        values.middleCols(c * every, std::min(every, values.cols() - c * every)).rowwise().mean();
  return out;
}

std::string panel_tags(const HeatMap& panel, double left, double low, double high, bool first) {
  const Eigen::MatrixXd values = few_columns(panel.values);
  const double width = kPanel / static_cast<double>(values.cols());
  const double height = kPanelHeight / static_cast<double>(values.rows());
  std::string tags = "<g shape-rendering=\"crispEdges\">\n";
  for (Eigen::Index c = 0; c < values.cols(); ++c)
    for (Eigen::Index r = 0; r < values.rows(); ++r)
      if (std::isfinite(values(r, c)))
        tags += "<rect x=\"" + number(left + width * static_cast<double>(c)) + "\" y=\"" +
                number(kPanelTop + kPanelHeight - height * static_cast<double>(r + 1)) +
                "\" width=\"" + number(width + 0.05) + "\" height=\"" + number(height + 0.05) +
                "\" fill=\"" + colour(high > low ? (values(r, c) - low) / (high - low) : 0) +
                "\"/>\n";
  tags += "</g>\n" + svg::text(left + kPanel / 2, kPanelTop - 8, "middle", panel.title);
  for (const double tick : plot_ticks(0, panel.x_high, false, 5))
    tags += svg::text(left + kPanel * tick / panel.x_high, kPanelTop + kPanelHeight + 16, "middle",
                      number(tick));
  if (first)
    for (const double tick : plot_ticks(0, panel.y_high, false, 6))
      tags += svg::text(left - 6, kPanelTop + kPanelHeight - kPanelHeight * tick / panel.y_high + 4,
                        "end", number(tick));
  return tags;
}

}  // namespace

std::string heat_maps_svg(const std::string& title, const std::string& x_label,
                          const std::string& y_label, const std::vector<HeatMap>& panels) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const HeatMap& panel : panels)
    for (Eigen::Index i = 0; i < panel.values.size(); ++i)
      if (const double value = panel.values.data()[i]; std::isfinite(value)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
  if (low > high) throw UsageError("there is nothing to draw: no finite values");
  const auto count = static_cast<double>(panels.size());
  const double width = kPanelLeft + count * (kPanel + kGap),
               height = kPanelTop + kPanelHeight + kPanelBottom;
  std::string tags = svg::open(width, height, title);
  double left = kPanelLeft;
  for (const HeatMap& panel : panels) {
    if (panel.values.size() > 0) tags += panel_tags(panel, left, low, high, left == kPanelLeft);
    left += kPanel + kGap;
  }
  const double middle = kPanelTop + kPanelHeight / 2;
  tags += svg::text((kPanelLeft + width) / 2, height - 12, "middle", x_label);
  tags += svg::text(18, middle, "middle", y_label,
                    "transform=\"rotate(-90 18 " + number(middle) + ")\"");
  return tags + "</svg>\n";
}

}  // namespace mocaplm
