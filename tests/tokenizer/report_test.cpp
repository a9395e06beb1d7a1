#include "tokenizer/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/angles.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"
#include "support/small_dataset.h"
#include "tokenizer/tokenize.h"

namespace mocaplm::report_test {
namespace {

namespace fs = std::filesystem;

std::vector<Clip> some_clips(std::uint64_t first) {
  std::vector<Clip> clips;
  for (std::uint64_t seed = first; seed < first + 3; ++seed)
    clips.push_back(random_clip(seed, 90, 20));
  return clips;
}

TEST(ReportSettings, SpecsChangeTheBase) {
  ReportSetting base;
  base.frames.fps = 60;
  base.frames.bins = 90;
  const auto settings =
      report_settings({"bins:180,binning:quantile", "tiles:60,keep:0.2,pca:42,lapped",
                       "tiles:30,root:absolute,joints:pelvis+left_leg,lapped:false"},
                      base);
  ASSERT_EQ(settings.size(), 3u);
  EXPECT_EQ(settings[0].frames.bins, 180);
  EXPECT_EQ(settings[0].frames.binning, "quantile");
  EXPECT_EQ(settings[0].frames.fps, 60);
  EXPECT_EQ(settings[0].frames.root, "steps");
  EXPECT_EQ(settings[1].tiles.pca, 42);
  EXPECT_EQ(settings[1].tiles.keep, 0.2);
  EXPECT_TRUE(settings[1].tiles.lapped);
  EXPECT_EQ(settings[1].frames.bins, 90);
  EXPECT_EQ(settings[1].frames.root, "none") << "tiles tell no steps";
  EXPECT_EQ(settings[1].name, "tiles:60,keep:0.2,pca:42,lapped");
  EXPECT_EQ(settings[2].frames.root, "absolute");
  EXPECT_EQ(settings[2].frames.joints, (std::vector<std::string>{"pelvis", "left_leg"}));
  EXPECT_FALSE(settings[2].tiles.lapped);
}

TEST(ReportSettings, ListsComeFromAFileToo) {
  const fs::path file = fs::path(testing::TempDir()) / "mocaplm_report_settings.json";
  write_file(file, R"([{"bins": 90}, {"tiles": 30, "lapped": true, "joints": ["spine"]}])");
  const auto settings = report_settings({file.string(), "bins:7"}, {});
  ASSERT_EQ(settings.size(), 3u);
  EXPECT_EQ(settings[0].frames.bins, 90);
  EXPECT_EQ(settings[1].tiles.tiles, 30);
  EXPECT_EQ(settings[1].frames.joints, std::vector<std::string>{"spine"});
  EXPECT_EQ(settings[2].frames.bins, 7);
  write_file(file, "{}");
  EXPECT_PRED2(contains, refusal([&] { report_settings({file.string()}, {}); }), "list");
  fs::remove(file);
}

TEST(ReportSettings, RefuseWhatIsWrongByName) {
  const auto says = [](const std::string& spec, const std::string& part) {
    EXPECT_PRED2(contains, refusal<UsageError>([&] { report_settings({spec}, {}); }), part);
  };
  says("bin:90", "did you mean \"bins\"");
  says("bins:many", "\"bins\": expected a whole number");
  says("bins:1", "\"bins\": expected 2 to 4096");
  says("tiles:60,keep:nan", "\"keep\": expected a number");
  says("lapped:perhaps", "\"lapped\": expected true or false");
  says("scan:zigzag", "\"scan\": expected one of");
  says("", "there is no setting \"\"");
}

// The columns by hand for uniform bins over frames.
TEST(Report, CountsAndErrorsOfUniformBins) {
  const std::vector<Clip> clips = some_clips(1);
  ReportSetting setting;
  setting.name = "b";
  setting.frames.bins = 90;
  setting.frames.root = "none";
  const std::vector<ReportRow> rows = report({setting}, some_clips(9), clips);
  ASSERT_EQ(rows.size(), 1u);
  const WordMeasure& m = rows[0].measure;
  EXPECT_EQ(m.clips, 3);
  EXPECT_EQ(m.frames, 270);
  EXPECT_EQ(m.words, 270);
  EXPECT_EQ(m.word_length(), 39) << "equation 4.5";
  EXPECT_EQ(m.longest, 39);
  EXPECT_NEAR(m.seconds_in(1024), 1024.0 / 39 / 20, 1e-12);
  EXPECT_NEAR(m.seconds_in_fact(1024), 1024.0 / 40 / 20, 1e-12);
  EXPECT_NEAR(m.compression(), 270.0 * 72 * 8 / (270 * 40 + 91), 1e-9) << "90 bins are ASCII";

  TokenizerConfig config = setting.frames;
  const Tokenizer tokenizer = Tokenizer::fit(config, {});
  Tally geodesic, joint, frame;
  for (const Clip& clip : clips) {
    const Clip back = tokenizer.decode(tokenizer.encode(clip).ids);
    const Eigen::MatrixXd before = tokenizer.rotation_values(clip);
    const Eigen::MatrixXd after = tokenizer.rotation_values(back);
    for (Eigen::Index t = 0; t < before.rows(); ++t) {
      frame.add(
          std::acos(before.row(t).dot(after.row(t)) / before.row(t).norm() / after.row(t).norm()));
      for (Eigen::Index c = 0; c < 39; c += 3) {
        const Eigen::Vector3d a = before.row(t).segment<3>(c), b = after.row(t).segment<3>(c);
        joint.add(std::acos(a.dot(b) / a.norm() / b.norm()));
        const Eigen::Matrix3d turn =
            matrix_from_axis_angle(a).transpose() * matrix_from_axis_angle(b);
        geodesic.add(std::acos(std::min(1.0, 0.5 * (turn.trace() - 1))));
      }
    }
  }
  EXPECT_NEAR(m.joint_vectors.mean(), joint.mean(), 1e-7);
  EXPECT_NEAR(m.joint_vectors.max, joint.max, 1e-7);
  EXPECT_NEAR(m.frame_vectors.mean(), frame.mean(), 1e-7);
  EXPECT_NEAR(m.geodesic.mean(), geodesic.mean(), 1e-6);
  EXPECT_NEAR(m.geodesic.max, geodesic.max, 1e-6);
  EXPECT_GT(m.position.mean(), 0.1);
  EXPECT_LT(m.position.mean(), 5);
}

TEST(Report, VectorAngles) {
  const Eigen::Vector3d x(2, 0, 0), y(0, 3, 0), zero = Eigen::Vector3d::Zero();
  EXPECT_NEAR(vector_angle(x, y), kPi / 2, 1e-15);
  EXPECT_NEAR(vector_angle(x, -x), kPi, 1e-15);
  EXPECT_EQ(vector_angle(x, 5 * x), 0);
  EXPECT_EQ(vector_angle(zero, zero), 0);
  EXPECT_EQ(vector_angle(x, zero), kPi / 2);
  EXPECT_NEAR(vector_angle(x, Eigen::Vector3d(2, 1e-9, 0)), 5e-10, 1e-16);
}

TEST(Report, TilesTellMoreSecondsForMoreError) {
  const auto settings = report_settings(
      {"tiles:30,keep:0.05", "tiles:30,keep:0.2", "tiles:30,keep:0.2,lapped", "bins:360"}, {});
  const std::vector<ReportRow> rows = report(settings, some_clips(1), some_clips(1));
  EXPECT_GT(rows[0].measure.seconds_in(1024), 2 * rows[1].measure.seconds_in(1024));
  EXPECT_GT(rows[0].measure.geodesic.mean(), 1.5 * rows[1].measure.geodesic.mean());
  EXPECT_GT(rows[1].measure.seconds_in(1024), 3 * rows[3].measure.seconds_in(1024));
  EXPECT_LT(rows[2].measure.seam(), rows[1].measure.seam());
  EXPECT_EQ(report_table(rows).rows().size(), 4u);
}

TEST(Report, FitsOnTheTrainingSplitAndMeasuresOnTheTestSplit) {
  const TemporaryFolder folder;
  write_dataset(
      folder.path(),
      {{"a", "train", 60}, {"b", "train", 80}, {"c", "validation", 50}, {"d", "test", 70}});
  TokenizeOptions options;
  options.inputs = {folder.path().string()};
  std::string note;
  const std::vector<ReportRow> rows = tokenize_report(options, {"bins:90"}, note);
  EXPECT_EQ(rows[0].measure.clips, 1);
  EXPECT_EQ(rows[0].measure.frames, 70);
  EXPECT_PRED2(contains, note, "fitted on 2 clips (7 s), measured on 1 clips (4 s) not among them");
  options.inputs = {(folder / "clips/a.npz").string()};
  EXPECT_EQ(tokenize_report(options, {"bins:90"}, note)[0].measure.frames, 60);
  EXPECT_PRED2(contains, note, "the same clips");
}

}  // namespace
}  // namespace mocaplm::report_test
