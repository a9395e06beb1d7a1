#include "viewer/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/error.h"
#include "support/refusal.h"

namespace mocaplm::plot_test {
namespace {

TEST(PlotTicks, AreRoundNumbersInside) {
  EXPECT_EQ(plot_ticks(0, 10, false), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(plot_ticks(-1.2, 1.2, false, 5), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
  EXPECT_EQ(plot_ticks(1, 100, true), (std::vector<double>{1, 2, 5, 10, 20, 50, 100}));
  EXPECT_EQ(plot_ticks(15, 55, true), (std::vector<double>{20, 30, 40, 50}));
  EXPECT_EQ(plot_ticks(1, 1e6, true), (std::vector<double>{1, 10, 100, 1e3, 1e4, 1e5, 1e6}));
  for (const double scale : {1e-7, 1.0, 3.7, 1e9})
    for (const int most : {2, 5, 8}) {
      const std::vector<double> ticks = plot_ticks(-0.3 * scale, 0.9 * scale, false, most);
      EXPECT_GE(ticks.size(), 1u);
      EXPECT_LE(ticks.size(), static_cast<std::size_t>(most) + 1);
      for (const double tick : ticks) {
        EXPECT_GE(tick, -0.3 * scale * 1.0001);
        EXPECT_LE(tick, 0.9 * scale * 1.0001);
      }
    }
}

TEST(Plot, HoldsEveryPointWithItsValues) {
  Plot plot{"Error & size", "bins", "degrees", true, true, {}};
  plot.series.push_back({"mean", {{90, 1.03, "b90"}, {360, 0.25, ""}}, true});
  plot.series.push_back({"max", {{90, 2, ""}}, false});
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(svg.rfind("<svg xmlns=", 0), 0u);
  EXPECT_PRED2(contains, svg, "<title>Error &amp; size</title>");
  EXPECT_PRED2(contains, svg, "<title>b90\nbins: 90\ndegrees: 1.03</title>");
  EXPECT_PRED2(contains, svg, "<title>max\nbins: 90\ndegrees: 2</title>");
  EXPECT_EQ(count(svg, "<polyline"), 1u);
  EXPECT_EQ(count(svg, "<circle"), 3u + 2u) << "three points, two in the legend";
  EXPECT_EQ(count(svg, "http"), 1u) << "the name space, nothing to load";
  EXPECT_EQ(count(svg, "<title>"), count(svg, "</title>"));
}

TEST(Plot, DrawsLinesWithoutDotsInAColourOfTheirOwn) {
  Plot plot{"", "x", "y", false, false, {{"a", {{0, 1, ""}, {1, 2, ""}}}, {"b", {{0, 2, ""}}}}};
  plot.series[0].dots = false;
  plot.series[0].colour = "#bbbbbb";
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(count(svg, "<circle"), 3u) << "one point, two in the legend";
  EXPECT_EQ(count(svg, "\"#bbbbbb\""), 2u) << "line and legend";
  EXPECT_EQ(count(svg, "#0072b2"), 3u) << "b takes the palette's first";
}

// Where the points lie in the picture: further right and further up for larger values.
TEST(Plot, LargerIsFurtherRightAndUp) {
  for (const bool log : {false, true}) {
    Plot plot{"", "x", "y", log, log, {{"", {{1, 1, ""}, {10, 100, ""}, {50, 1000, ""}}, true}}};
    const std::string svg = plot_svg(plot);
    double last_x = -1, last_y = 1e9;
    for (std::size_t at = svg.find("cx="); at != std::string::npos; at = svg.find("cx=", at + 1)) {
      const double x = std::stod(svg.substr(at + 4)),
                   y = std::stod(svg.substr(svg.find("cy=", at) + 4));
      EXPECT_GT(x, last_x);
      EXPECT_LT(y, last_y);
      EXPECT_GE(x, 34);
      EXPECT_LE(x, 560 - 18);
      last_x = x;
      last_y = y;
    }
  }
}

TEST(Plot, LeavesOutWhatItCannotShow) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Plot plot{"", "x", "y", true, false, {{"a", {{nan, 1, ""}, {0, 1, ""}, {-1, 1, ""}}, true}}};
  EXPECT_THROW(plot_svg(plot), UsageError);
  plot.series[0].points.push_back({5, 3, ""});
  const std::string svg = plot_svg(plot);
  EXPECT_EQ(count(svg, "<circle"), 2u);
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_EQ(count(svg, "inf"), 0u);
}

TEST(Plot, ItsTableHasEveryPoint) {
  Plot plot{"Error", "bins", "degrees", false, false, {}};
  plot.series.push_back({"mean", {{90, 1.034567, "b90"}, {360, 0.25, ""}}});
  plot.series.push_back({"", {{90, 2, "odd"}}});
  const Table table = plot_table(plot);
  EXPECT_EQ(table.title(), "Error");
  EXPECT_EQ(table.columns(), (std::vector<std::string>{"", "bins", "degrees"}));
  ASSERT_EQ(table.rows().size(), 3u);
  EXPECT_EQ(table.rows()[0], (std::vector<Json>{"mean: b90", 90.0, 1.035}));
  EXPECT_EQ(table.rows()[1][0], "mean");
  EXPECT_EQ(table.rows()[2][0], "odd");
}

}  // namespace
}  // namespace mocaplm::plot_test
