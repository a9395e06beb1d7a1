#include "viewer/heat_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/error.h"
#include "support/refusal.h"

namespace mocaplm::heat_map_test {
namespace {

TEST(HeatMap, DrawsEveryValueOnOneScale) {
  Eigen::MatrixXd a(2, 3), b(1, 1);
  a << 0, 1, 2, 3, 4, std::numeric_limits<double>::quiet_NaN();
  b << 8;
  const std::string svg = heat_maps_svg("<T>", "s", "Hz", {{"a & b", a, 3, 2}, {"c", b, 1, 1}});
  EXPECT_EQ(count(svg, "<rect"), 1u + 5 + 1);  // the background, what is finite
  EXPECT_EQ(count(svg, "fill=\"#440154\""), 1u);
  EXPECT_EQ(count(svg, "fill=\"#fde725\""), 1u);
  EXPECT_EQ(count(svg, "fill=\"#21918c\""), 1u);  // 4 of 8
  EXPECT_TRUE(contains(svg, "&lt;T&gt;"));
  EXPECT_TRUE(contains(svg, "a &amp; b"));
}

TEST(HeatMap, ManyColumnsAreAveraged) {
  const std::string svg =
      heat_maps_svg("t", "x", "y", {{"long", Eigen::MatrixXd::Random(2, 1001), 1, 1}});
  EXPECT_LE(count(svg, "<rect"), 2u * 400 + 1);
  EXPECT_EQ(
      count(heat_maps_svg("t", "x", "y", {{"flat", Eigen::MatrixXd::Ones(2, 2), 1, 1}}), "<rect"),
      5u);
  EXPECT_NE(refusal<UsageError>([] { heat_maps_svg("t", "x", "y", {{"none", {}, 1, 1}}); }), "");
}

}  // namespace
}  // namespace mocaplm::heat_map_test
