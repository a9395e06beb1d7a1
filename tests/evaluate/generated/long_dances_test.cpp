#include "evaluate/generated/long_dances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/temporary_folder.h"
#include "evaluate/generated/motion_measures.h"
#include "evaluate/generated/small_dancer.h"
#include "support/refusal.h"

namespace mocaplm::long_dances_test {
namespace {

class LongDances : public testing::Test {
 protected:
  void SetUp() override {
    write_small_dataset(folder_ / "data");
    save_model(folder_ / "model", small_dancer());
    options_.data = folder_ / "data";
    options_.models = {folder_ / "model"};
    options_.precision = "f32";
    options_.seconds = 4;
    options_.seed_seconds = 1;
    options_.dances = 5;  // of three clips
  }
  TemporaryFolder folder_;
  LongOptions options_;
};

std::map<std::string, std::vector<Json>> rows(const Table& table) {
  std::map<std::string, std::vector<Json>> all;
  for (const auto& row : table.rows()) all[row[0].get<std::string>()] = row;
  return all;
}

TEST_F(LongDances, TellsTheDataTheDancesAndTheirSpread) {
  const std::vector<Table> tables = long_tables(options_);
  ASSERT_EQ(tables.size(), 2u);
  for (const auto& [name, row] : rows(tables[0])) {
    ASSERT_TRUE(row[3].is_number()) << name;
    if (name.find("lowest") == std::string::npos && name.find("highest") == std::string::npos &&
        name.find("most from") == std::string::npos) {
      EXPECT_LE(row[4].get<double>(), row[3].get<double>() + 1e-12) << name;
      EXPECT_GE(row[5].get<double>(), row[3].get<double>() - 1e-12) << name;
    }
  }
  // The data, from the pieces.
  const Dataset dataset = load_dataset(folder_ / "data");
  const Tokenizer tokenizer =
      Tokenizer::from_json(load_model(folder_ / "model").tokenizer, "model");
  MotionMeasures data;
  for (const DatasetEntry& entry : dataset.split("test")) {
    const Clip clip = tokenizer.at_rate(load_clip(dataset, entry));
    data.add(measure_motion(clip, tokenizer.joints(), toe_level(clip)));
  }
  EXPECT_NEAR(rows(tables[0]).at("root: speed, m/s")[1].get<double>(), data.root_speed.value(),
              1e-9);
  EXPECT_NEAR(rows(tables[0]).at("joints: jerk, m/s3")[1].get<double>(), data.jerk.value(), 1e-6);
  const auto time = rows(tables[1]);
  for (const char* part : {"data, tokenized", "0 to 1", "1 to 2", "2 to 3", "3 to 4"})
    EXPECT_EQ(time.count(part), 1u) << part;
  EXPECT_NE(tables[0].notes()[0].find("5 dances after 1 s"), std::string::npos);
}

TEST_F(LongDances, Repeats) {
  const std::vector<Table> tables = long_tables(options_);
  options_.threads = 1;
  EXPECT_EQ(long_tables(options_)[0].json(), tables[0].json());
  options_.sampling.seed = 9;
  EXPECT_NE(long_tables(options_)[0].json(), tables[0].json());
}

TEST_F(LongDances, SeveralModelsEachBesideItsOwnViewOfTheData) {
  save_model(folder_ / "arm", small_dancer({"right_elbow"}));
  options_.models.push_back(folder_ / "arm");
  const std::vector<Table> tables = long_tables(options_);
  ASSERT_EQ(tables.size(), 4u);
  EXPECT_NE(tables[2].title().find("arm"), std::string::npos);
}

TEST_F(LongDances, RefusesWhatCannotBe) {
  options_.seed_seconds = 60;
  EXPECT_NE(refusal([&] { long_tables(options_); }).find("shorter --seed-seconds"),
            std::string::npos);
  options_.where = {"style=none"};
  EXPECT_NE(refusal<UsageError>([&] { long_tables(options_); }).find("style=none"),
            std::string::npos);
}

}  // namespace
}  // namespace mocaplm::long_dances_test
