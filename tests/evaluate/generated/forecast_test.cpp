// The comparison as a whole: rows, notes, refusals, and that scores are the metrics' own.
#include "evaluate/generated/forecast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/temporary_folder.h"
#include "evaluate/generated/small_dancer.h"
#include "motion/resample.h"
#include "support/refusal.h"

namespace mocaplm::forecast_test {
namespace {

class Forecast : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_small_dataset(*folder_ / "data");
    save_model(*folder_ / "model", small_dancer());
    save_model(*folder_ / "knee", small_dancer({"left_knee", "right_wrist"}));
    save_model(*folder_ / "wrist", small_dancer({"right_wrist"}));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static ForecastOptions options(const std::vector<std::string>& models = {}) {
    ForecastOptions o;
    o.data = *folder_ / "data";
    for (const std::string& model : models) o.models.push_back(*folder_ / model);
    o.samples = 2;
    o.precision = "f32";
    return o;
  }
  static std::vector<std::string> names(const Table& table) {
    std::vector<std::string> all;
    for (const auto& row : table.rows()) all.push_back(row[0].get<std::string>());
    return all;
  }
  static std::string notes(const std::vector<Table>& tables) {
    std::string all;
    for (const std::string& note : tables.back().notes()) all += note + "\n";
    return all;
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};

std::unique_ptr<TemporaryFolder> Forecast::folder_;

TEST_F(Forecast, WithoutAModelTheSimpleOnesInTheProtocol) {
  const std::vector<Table> tables = forecast_tables(options());
  ASSERT_EQ(tables.size(), 4u);
  for (const Table& table : tables) {
    EXPECT_EQ(table.columns().size(), 5u);
    EXPECT_EQ(names(table)[0], "zero velocity");
    EXPECT_EQ(names(table)[1], "linear extrapolation");
    EXPECT_EQ(names(table)[2], "AMASS: zero velocity");
  }
  // a has windows from 0 and 2 s, b one, c none.
  EXPECT_NE(notes(tables).find("3 windows from 3 clips (1 were too short)"), std::string::npos)
      << notes(tables);
  for (const char* same : {"rate:", "seen:", "joints:", "- horizons"})
    EXPECT_EQ(notes(tables).find(same), std::string::npos) << same;

  // Zero velocity, from the pieces.
  const Dataset dataset = load_dataset(*folder_ / "data");
  std::vector<ForecastWindow> windows;
  std::vector<Clip> targets;
  for (const DatasetEntry& entry : dataset.split("test"))
    for (const auto& window : forecast_windows(resample(load_clip(dataset, entry), 60), 120, 24)) {
      windows.push_back(window);
      targets.push_back(window.target);
    }
  const ForecastMetrics metrics(forecast_joints(), targets);
  double euler = 0, auc = 0;
  for (const ForecastWindow& window : windows) {
    const auto score =
        score_until(metrics.errors(zero_velocity(window.seed, 24), window.target), 12, 200);
    euler += score.euler / 3, auc += score.auc / 3;
  }
  EXPECT_NEAR(tables[0].rows()[0][2].get<double>(), euler, 1e-9);
  EXPECT_NEAR(tables[3].rows()[0][2].get<double>(), auc, 1e-9);
}

TEST_F(Forecast, ModelsSideBySide) {
  ForecastOptions o = options({"model", "knee"});
  o.horizons = {400, 100, 250};
  const std::vector<Table> tables = forecast_tables(o);
  for (const Table& table : tables) {
    ASSERT_EQ(names(table).size(), 2u + 2 * 3 + 3);
    EXPECT_EQ(table.columns()[2], "250 ms");
    for (std::size_t model = 0; model < 2; ++model)
      for (std::size_t h = 1; h <= 3; ++h) {
        const double mean = table.rows()[3 + 3 * model][h], best = table.rows()[4 + 3 * model][h];
        EXPECT_TRUE(std::isfinite(mean));
        if (&table == &tables.back())
          EXPECT_GE(best, mean);
        else
          EXPECT_LE(best, mean);
      }
    EXPECT_TRUE(table.rows().back()[2].is_null());  // 250 ms were not published
  }
  EXPECT_NE(notes(tables).find("joints: 1 of the 15"), std::string::npos) << notes(tables);
  EXPECT_NE(notes(tables).find("sees and tells 20 frames"), std::string::npos);
  EXPECT_NE(notes(tables).find("- horizons"), std::string::npos);
  // It repeats, and windows decoded with others are what they are alone.
  o.threads = 1;
  const std::vector<Table> again = forecast_tables(o);
  for (std::size_t i = 0; i < tables.size(); ++i) EXPECT_EQ(again[i].json(), tables[i].json());
}

TEST_F(Forecast, SaysWhatDiffers) {
  ForecastOptions o = options({"model"});
  o.fps = 25;
  o.seed_seconds = 1;
  o.windows = 2;
  o.samples = 0;
  o.horizons = {100, 200};
  const std::vector<Table> tables = forecast_tables(o);
  EXPECT_EQ(names(tables[0]).size(), 2u + 1 + 3);
  for (const char* part : {"2 windows of ", "rate: 25 frames", "seen: 1 s", "100 ms are taken as",
                           "joints: 2 of the 15", "model sees and tells 20"})
    EXPECT_NE(notes(tables).find(part), std::string::npos) << part << "\n" << notes(tables);
  o.all_joints = true;
  EXPECT_NE(notes(forecast_tables(o)).find("model lacks left_hip"), std::string::npos);
}

TEST_F(Forecast, RefusesWhatCannotBe) {
  const auto usage = [](const ForecastOptions& o) {
    return refusal<UsageError>([&] { forecast_tables(o); });
  };
  ForecastOptions o = options();
  o.horizons = {5};
  EXPECT_NE(usage(o).find("--horizons 5"), std::string::npos);
  o.horizons = {};
  EXPECT_NE(usage(o).find("--horizons"), std::string::npos);
  o = options();
  o.seed_seconds = 0.01;
  EXPECT_NE(usage(o).find("--seed-seconds"), std::string::npos);
  EXPECT_NE(usage(options({"wrist"})).find("--all-joints"), std::string::npos);
  o = options();
  o.seed_seconds = 9;
  EXPECT_NE(refusal([&] { forecast_tables(o); }).find("shorter --seed-seconds"), std::string::npos);
  EXPECT_NE(refusal([&] { forecast_tables(options({"none"})); }).find("none"), std::string::npos);
}

}  // namespace
}  // namespace mocaplm::forecast_test
