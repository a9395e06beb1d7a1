// The learning-rate range test: what a curve says, and a curve of a tiny model.
#include "train/range_test.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"

namespace fs = std::filesystem;

namespace mocaplm::range_test_test {
namespace {

// Rates from 1e-5 to 1, a thousandth of a decade apart; `loss` of the rate's logarithm to base 10.
template <class Loss>
RangeTestResult read(const Loss& loss) {
  std::vector<double> rates, losses;
  for (int i = 0; i <= 500; ++i) {
    const double x = -5 + 0.01 * i;
    rates.push_back(std::pow(10, x));
    losses.push_back(loss(x));
  }
  return read_range(rates, losses);
}

TEST(RangeTest, FindsTheSteepestPlaceAndTheTurningPoint) {
  // Falls as a logistic curve about 1e-3, rises from 10^-1.5 on.
  const RangeTestResult r = read([](double x) {
    return 6 - 4 / (1 + std::exp(-6 * (x + 3))) + (x > -1.5 ? 8 * (x + 1.5) * (x + 1.5) : 0);
  });
  EXPECT_NEAR(std::log10(r.steepest), -3, 0.05);
  EXPECT_NEAR(std::log10(r.lowest), -1.5, 0.3);  // where the fall ends
  EXPECT_TRUE(r.rises);
  EXPECT_DOUBLE_EQ(r.proposed, r.steepest);
}

TEST(RangeTest, IsAtMostATenthOfWhereTheLossTurns) {
  const RangeTestResult r = read([](double x) {
    return 6 - 4 / (1 + std::exp(-20 * (x + 2))) + (x > -1.8 ? 8 * (x + 1.8) * (x + 1.8) : 0);
  });
  EXPECT_NEAR(std::log10(r.steepest), -2, 0.1);
  EXPECT_DOUBLE_EQ(r.proposed, r.lowest / 10);
}

TEST(RangeTest, SaysWhenTheLossNeverRose) {
  const RangeTestResult r = read([](double x) { return 3 - x; });
  EXPECT_FALSE(r.rises);
  EXPECT_DOUBLE_EQ(r.proposed, r.steepest);
  EXPECT_TRUE(contains(range_test_table(r).text(), "--range-high"));
}

TEST(RangeTest, NoiseDoesNotDecide) {
  Random random(1);
  const RangeTestResult r = read([&](double x) {
    return 6 - 4 / (1 + std::exp(-6 * (x + 3))) + (x > -1.5 ? 8 * (x + 1.5) * (x + 1.5) : 0) +
           0.02 * random.normal();
  });
  EXPECT_NEAR(std::log10(r.steepest), -3, 0.4);
  EXPECT_EQ(r.smooth.size(), r.losses.size());
}

TEST(RangeTest, ReadsTheCurveOfATinyModel) {
  const TemporaryFolder folder;
  write_dataset(folder / "data", {{"a", "train", 80}, {"b", "validation", 30}});
  TrainOptions o;
  o.config.tokenizer.bins = 24;
  o.config.tokenizer.joints = {"left_knee", "right_elbow"};
  o.config.tokenizer.root = "none";
  o.config.model.n_layer = 1;
  o.config.model.n_head = 2;
  o.config.model.n_embd = 16;
  o.config.model.block_size = 96;
  o.config.model.reach = 6;
  o.config.train.batch_size = o.config.train.micro_batch = 2;
  o.config.train.precision = "f32";
  o.data = folder / "data";
  o.out = folder / "out";
  o.device = "cpu";
  o.threads = 1;
  const RangeTestResult r = range_test(o, {60, 1e-5, 10});
  EXPECT_GE(r.rates.size(), 10u);
  EXPECT_LE(r.rates.size(), 60u);
  for (std::size_t i = 1; i < r.rates.size(); ++i)
    EXPECT_NEAR(std::log(r.rates[i] / r.rates[i - 1]), std::log(1e6) / 59, 1e-9);
  EXPECT_TRUE(r.rises);
  EXPECT_GT(r.proposed, 1e-5);
  EXPECT_LT(r.proposed, 1);
  const Json json = load_json(o.out / "range_test.json");
  EXPECT_EQ(json["rates"].size(), r.rates.size());
  EXPECT_EQ(json["proposed"], r.proposed);
  EXPECT_FALSE(fs::exists(o.out / "best"));
  const RangeTestResult again = range_test(o, {60, 1e-5, 10});
  EXPECT_EQ(again.losses, r.losses);
  EXPECT_THROW(range_test(o, {60, 1e-2, 1e-3}), UsageError);
}

}  // namespace
}  // namespace mocaplm::range_test_test
