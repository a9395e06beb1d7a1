#include "tokenizer/bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "common/random.h"
#include "support/refusal.h"

namespace mocaplm::bins_test {
namespace {

// The bin by looking at every edge.
int slow_bin(const Bins& bins, double value) {
  int bin = 0;
  for (const double edge : bins.edges()) bin += value >= edge;
  return bin;
}

std::vector<double> normals(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = random.normal();
  return values;
}

TEST(Bins, HoldEquallyManyValuesAndDecodeToTheirMean) {
  const std::vector<double> values = normals(10000, 1);
  for (const int count : {2, 3, 7, 90, 360, 4096}) {
    const Bins bins = Bins::quantile(values, count);
    ASSERT_EQ(bins.count(), count);
    std::vector<int> filled(static_cast<std::size_t>(count));
    std::vector<double> sums(filled.size());
    for (const double value : values) {
      const int bin = bins.of(value);
      ASSERT_EQ(bin, slow_bin(bins, value));
      ++filled[static_cast<std::size_t>(bin)];
      sums[static_cast<std::size_t>(bin)] += value;
    }
    const auto [least, most] = std::minmax_element(filled.begin(), filled.end());
    EXPECT_LE(*most - *least, 1) << count;
    for (std::size_t b = 0; b < filled.size(); ++b) {
      EXPECT_NEAR(bins.centre(static_cast<int>(b)), sums[b] / filled[b], 1e-12);
      EXPECT_EQ(bins.of(bins.centre(static_cast<int>(b))), static_cast<int>(b));
    }
  }
}

TEST(Bins, TiesShareABinAndLeaveNoneEmpty) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    // Few different values, some of them much more frequent than others.
    const int different = 1 + static_cast<int>(random.below(40));
    std::vector<double> values;
    for (int i = 0; i < 200; ++i) {
      const double u = random.uniform();
      values.push_back(std::floor(u * u * u * different) - 7);
    }
    const std::set<double> distinct(values.begin(), values.end());
    const int count = 1 + static_cast<int>(random.below(50));
    const Bins bins = Bins::quantile(values, count);
    EXPECT_EQ(bins.count(), std::min(count, static_cast<int>(distinct.size())));
    std::set<int> used;
    for (const double value : distinct) used.insert(bins.of(value));
    EXPECT_EQ(used.size(), static_cast<std::size_t>(bins.count()));
    if (bins.count() < static_cast<int>(distinct.size())) continue;
    for (const double value : distinct) EXPECT_EQ(bins.centre(bins.of(value)), value);
  }
}

TEST(Bins, RoundingDoesNotMakeDifferentValues) {
  const Bins bins = Bins::quantile({0, 1e-17, -1e-16, 1, 1 + 1e-15}, 360);
  EXPECT_EQ(bins.count(), 2);
  EXPECT_NEAR(bins.centre(0), 0, 1e-15);
  EXPECT_EQ(bins.centre(359), bins.centre(1)) << "a bin that is not there is the last one";
  EXPECT_EQ(Bins::quantile({5}, 9).of(-1e300), 0);
}

TEST(Bins, AreFoundAtTheirEdges) {
  const Bins bins = Bins::quantile(normals(3000, 3), 37);
  for (std::size_t e = 0; e < bins.edges().size(); ++e) {
    const double edge = bins.edges()[e];
    EXPECT_EQ(bins.of(edge), static_cast<int>(e) + 1);
    EXPECT_EQ(bins.of(std::nextafter(edge, -1e9)), static_cast<int>(e));
  }
  EXPECT_EQ(bins.of(-1e300), 0);
  EXPECT_EQ(bins.of(1e300), 36);
}

TEST(Bins, AroundZeroHaveOneWidthAndNoZero) {
  const Bins bins = Bins::around_zero(0.5, 3);
  EXPECT_EQ(bins.centres(), (std::vector<double>{-1.5, -1, -0.5, 0.5, 1, 1.5}));
  EXPECT_EQ(bins.edges(), (std::vector<double>{-1.25, -0.75, 0, 0.75, 1.25}));
}

TEST(Bins, JsonIsExactAndChecked) {
  const Bins bins = Bins::quantile(normals(1000, 4), 50);
  const Json json = parse_json(bins.to_json().dump(), "bins");
  EXPECT_EQ(Bins::from_json(json, "bins", 50).exact_text(), bins.exact_text());
  const auto says = [&](const std::string& part, const std::function<void(Json&)>& change) {
    Json bad = json;
    change(bad);
    EXPECT_PRED2(contains, refusal([&] { Bins::from_json(bad, "bins", 50); }), part);
  };
  says("missing", [](Json& j) { j.erase("edges"); });
  says("unknown key", [](Json& j) { j["more"] = 1; });
  says("\"centres\": expected 1 to 50", [](Json& j) { j["centres"] = Json::array(); });
  says("\"centres\": expected 1 to 50", [](Json& j) { j["centres"].push_back(9); });
  says("\"centres\": expected 1 to 50", [](Json& j) { j["centres"][3] = j["centres"][4]; });
  says("\"edges\": expected 49", [](Json& j) { j["edges"].erase(0); });
  says("edge 0 does not lie", [](Json& j) { j["edges"][0] = -100; });
}

TEST(RowSample, KeepsEverySecondRowWhenThereAreMany) {
  RowSample sample(2, 10);
  for (int i = 0; i < 100; ++i) sample.add(std::vector<double>{double(i), -double(i)});
  EXPECT_TRUE(sample.thinned());
  const std::vector<double>& first = sample.column(0);
  ASSERT_GE(first.size(), 5u);
  EXPECT_LE(first.size(), 10u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], static_cast<double>(i) * first[1]) << "evenly spaced";
    EXPECT_EQ(sample.column(1)[i], -first[i]);
  }
}

}  // namespace
}  // namespace mocaplm::bins_test
