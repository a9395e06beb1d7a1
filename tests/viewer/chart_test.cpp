#include "viewer/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/error.h"
#include "support/refusal.h"

namespace mocaplm::chart_test {
namespace {

// The widths of the bars, which are the rectangles with numbers.
std::vector<double> widths(const std::string& svg) {
  std::vector<double> found;
  for (std::size_t at = svg.find("data-tip"); at != std::string::npos;
       at = svg.find("data-tip", at + 1))
    found.push_back(std::stod(svg.substr(svg.rfind(" width=\"", at) + 8)));
  return found;
}

TEST(Bars, AreAsLongAsTheirShares) {
  BarChart chart{"By <genre>", {"LDA", "Transformer"}, {}};
  chart.rows.push_back({"waack", {25, 100}, "12 clips"});
  chart.rows.push_back({"house", {std::numeric_limits<double>::quiet_NaN(), 50}, ""});
  const std::string svg = bars_svg(chart);
  const std::vector<double> wide = widths(svg);
  ASSERT_EQ(wide.size(), 3u) << "a share that is not known has no bar";
  EXPECT_NEAR(wide[0] / wide[1], 0.25, 1e-3);
  EXPECT_NEAR(wide[2] / wide[1], 0.5, 1e-3);
  EXPECT_PRED2(contains, svg, "<title>By &lt;genre&gt;</title>");
  EXPECT_PRED2(contains, svg, "<title>waack\nLDA: 25.0 %\n12 clips</title>");
  EXPECT_EQ(count(svg, "nan"), 0u);
}

TEST(Bars, RefuseWhatDoesNotFit) {
  EXPECT_THROW(bars_svg({"", {"a"}, {}}), UsageError);
  EXPECT_THROW(bars_svg({"", {"a"}, {{"row", {1, 2}, ""}}}), UsageError);
}

TEST(Matrix, TellsEachField) {
  const MatrixChart chart{"genre", {"waack", "house"}, {{3, 1}, {0, 0}}};
  const std::string svg = matrix_svg(chart);
  EXPECT_EQ(widths(svg).size(), 4u);
  EXPECT_PRED2(contains, svg, "<title>waack, found: 3 of 4 (75.0 %)</title>");
  EXPECT_PRED2(contains, svg, "<title>waack, taken for house: 1 of 4 (25.0 %)</title>");
  EXPECT_PRED2(contains, svg, "<title>house, found: 0 of 0 (0.0 %)</title>");
  EXPECT_EQ(count(svg, "fill-opacity=\"0.06\""), 2u) << "two empty fields";
}

TEST(Matrix, ManyClassesStayInThePicture) {
  MatrixChart chart{"dancer", {}, {}};
  for (int i = 0; i < 120; ++i) chart.classes.push_back("dancer " + std::to_string(i));
  chart.counts.assign(120, std::vector<long>(120, 1));
  const std::vector<double> wide = widths(matrix_svg(chart));
  EXPECT_EQ(wide.size(), 120u * 120u);
  EXPECT_GT(wide[0], 0);
  EXPECT_LT(120 * wide[0], 560);
  chart.counts.pop_back();
  EXPECT_THROW(matrix_svg(chart), UsageError);
  EXPECT_THROW(matrix_svg({"", {}, {}}), UsageError);
}

}  // namespace
}  // namespace mocaplm::chart_test
