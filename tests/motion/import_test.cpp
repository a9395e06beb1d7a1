#include "motion/import.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/formats/bvh.h"
#include "motion/formats/npz.h"
#include "motion/formats/scene.h"
#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm::import_test {
namespace {

class ImportTest : public ::testing::Test {
 protected:
  void write(const std::string& path, int seed, Eigen::Index frames = 12, double fps = 30) {
    Random random(static_cast<std::uint64_t>(seed));
    fs::create_directories((in_ / path).parent_path());
    write_npz(in_ / path, random_clip(random, frames, fps));
  }
  ImportReport import(const ImportConfig& config = {}) { return import_motion(config, job()); }
  ImportJob job() {
    ImportJob job;
    job.sources = {in_.path().string()};
    job.out = out();
    job.existing = existing_;
    job.strict = strict_;
    job.threads = threads_;
    return job;
  }
  fs::path out() const { return out_ / "set"; }
  std::map<std::string, DatasetEntry> entries() const {
    std::map<std::string, DatasetEntry> all;
    for (const DatasetEntry& entry : load_dataset(out()).entries) all[entry.name] = entry;
    return all;
  }

  TemporaryFolder in_, out_;
  Existing existing_ = Existing::refuse;
  bool strict_ = false;
  std::int64_t threads_ = 2;
};

TEST_F(ImportTest, FoldersAreSearchedAndNamesStayApart) {
  write("salsa/01.npz", 1);
  write("salsa/02.npz", 2);
  write("indian/02.npz", 3);
  write("walk.npz", 4);
  write("deep/er/shape.npz", 5);
  write_file(in_ / "readme.txt", "x");
  const ImportReport report = import();
  EXPECT_EQ(report.imported, 4u);
  EXPECT_EQ(report.ignored, 2u);
  const auto all = entries();
  EXPECT_EQ(
      all.count("walk") + all.count("salsa_01") + all.count("salsa_02") + all.count("indian_02"),
      4u);
  const Dataset dataset = load_dataset(out());
  for (const DatasetEntry& entry : dataset.entries)
    EXPECT_EQ(load_clip(dataset, entry).frames(), 12);
}

// A chair beside the takes is no broken file; alone it makes no dataset.
TEST_F(ImportTest, FilesWithoutMotionAreLeftOutWithARemark) {
  write("walk.npz", 1);
  write("chair.npz", 2);
  strict_ = true;
  ImportJob given = job();
  given.read = [](const fs::path& path, const ReadOptions& options) {
    if (path.stem() == "chair") throw NoMotion(in_file(path.string()), "has 3 meshes, no skeleton");
    return read_clips(path, options);
  };
  const ImportReport report = import_motion({}, given);
  EXPECT_EQ(report.imported, 1u);
  EXPECT_TRUE(report.broken.empty());
  const std::string chair = (in_ / "chair.npz").string() + " was left out, for it has 3 meshes";
  const auto lines = remark_lines(report);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("chair.npz: was left out, for it has 3 meshes, no skeleton") != line.npos;
  }));
  given.sources = {(in_ / "chair.npz").string()};
  given.out = out_ / "none";
  try {
    import_motion({}, given);
    FAIL() << "a chair is no dataset";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(chair), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(given.out));
}

TEST_F(ImportTest, LabelsFromNamesFoldersExpressionsAndTables) {
  write("d/gWA_sBM_cAll_d26_mWA2_ch03.npz", 1);
  write("d/dataset-1_bow_happy_001.npz", 2);
  write_file(in_ / "t.csv",
             "file,style,mood\nd/dataset-1_bow_happy_001.bvh,proud,\n"
             "dataset-1_bow_happy_001,calm,blue\nelse.npz,x,y\n");
  ImportConfig config;
  config.label_from_dir = "folder";
  config.label_regex = "^dataset-\\d_(?<content>[a-z-]+)_(?<style>[a-z-]+)_";
  config.label_csv = (in_ / "t.csv").string();
  const ImportReport report = import(config);
  const auto all = entries();
  EXPECT_EQ(all.at("gWA_sBM_cAll_d26_mWA2_ch03").labels, (Labels{{"genre", "waack"},
                                                                 {"situation", "basic"},
                                                                 {"dancer", "d26"},
                                                                 {"music", "mWA2"},
                                                                 {"choreography", "ch03"},
                                                                 {"folder", "d"}}));
  // ".bvh" in the table is not this file: the row without an extension is.
  EXPECT_EQ(all.at("dataset-1_bow_happy_001").labels,
            (Labels{{"folder", "d"}, {"content", "bow"}, {"style", "calm"}, {"mood", "blue"}}));
  EXPECT_EQ(report.warnings.size(), 3u);
}

TEST_F(ImportTest, PiecesAndCamerasOfOneAistDanceAreOneGroup) {
  int seed = 1;
  for (const char* name : {"gBR_sBM_c01_d04_mBR0_ch02_seg1", "gBR_sBM_c01_d04_mBR0_ch02_seg2",
                           "gBR_sBM_cAll_d04_mBR0_ch02_slice0", "gBR_sBM_cAll_d04_mBR0_ch02",
                           "gBR_sBM_c01_d04_mBR0_ch03_seg1", "walk"})
    write(std::string(name) + ".npz", seed++);
  import();
  std::map<std::string, int> groups;
  for (const auto& [name, entry] : entries()) {
    ++groups[entry.group];
    EXPECT_EQ(entry.labels.count("genre"), name == "walk" ? 0u : 1u) << name;
  }
  EXPECT_EQ(groups, (std::map<std::string, int>{{"gBR_sBM_cAll_d04_mBR0_ch02", 4},
                                                {"gBR_sBM_cAll_d04_mBR0_ch03", 1},
                                                {"walk", 1}}));
}

TEST_F(ImportTest, RatesAndLeadingFramesFromTheTable) {
  write("a.npz", 1, 20, 120);
  write("b.npz", 2, 20, 120);
  write_file(in_ / "t.csv", "file,true,intro,style\na.npz,60,10,happy\nb.npz,,,\n");
  ImportConfig config;
  config.label_csv = (in_ / "t.csv").string();
  config.csv_fps = "true";
  config.csv_drop_first = "intro";
  config.drop_first = 1;
  import(config);
  const auto all = entries();
  EXPECT_EQ(all.at("a").fps, 60);
  EXPECT_EQ(all.at("a").frames, 10);
  EXPECT_EQ(all.at("a").labels, (Labels{{"style", "happy"}}));
  EXPECT_EQ(all.at("b").fps, 120);
  EXPECT_EQ(all.at("b").frames, 19);
  // The frames are the last ones, bit for bit.
  const Dataset dataset = load_dataset(out());
  EXPECT_EQ(load_clip(dataset, all.at("a")).poses, read_npz(in_ / "a.npz").poses.bottomRows(10));

  existing_ = Existing::replace;
  write_file(in_ / "t.csv", "file,true,intro\na.npz,60 Hz,10\n");
  EXPECT_THROW(import(config), DataError);
  config.csv_fps = "treu";
  EXPECT_THROW(import(config), DataError);
  config.label_csv = "";
  EXPECT_THROW(import(config), UsageError);
}

TEST_F(ImportTest, BrokenFilesAreNamedAndTheOthersWritten) {
  write("a.npz", 1);
  write("b.npz", 2);
  write_file(in_ / "broken.npz", read_file(in_ / "a.npz").substr(0, 900));
  write_file(in_ / "empty.bvh", "");
  const ImportReport report = import();
  EXPECT_EQ(report.imported, 2u);
  ASSERT_EQ(report.broken.size(), 2u);
  EXPECT_NE(report.broken[0].reason.find("broken.npz"), std::string::npos);
  EXPECT_NE(report.broken[1].reason.find("empty.bvh"), std::string::npos);
  EXPECT_EQ(entries().size(), 2u);
}

TEST_F(ImportTest, StrictWritesNothing) {
  write("a.npz", 1);
  write_file(in_ / "broken.npz", "nothing");
  strict_ = true;
  EXPECT_THROW(import(), DataError);
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_TRUE(fs::is_empty(out_.path()));
  strict_ = false;
  fs::remove(in_ / "a.npz");
  EXPECT_THROW(import(), DataError);  // nothing sound is left
  EXPECT_TRUE(fs::is_empty(out_.path()));
}

TEST_F(ImportTest, CopiesShareAGroup) {
  for (int i = 0; i < 20; ++i) write("c" + std::to_string(i) + ".npz", i);
  write("copy.npz", 3);
  write("again.npz", 3);
  const ImportReport report = import();
  EXPECT_EQ(report.duplicates, (std::vector<std::vector<std::string>>{{"again", "c3", "copy"}}));
  const auto all = entries();
  EXPECT_EQ(all.at("copy").group, all.at("c3").group);
  EXPECT_EQ(all.at("copy").split, all.at("c3").split);
}

TEST_F(ImportTest, GroupsByExpressionOrTable) {
  for (int i = 1; i <= 9; ++i) write("s" + std::to_string(i) + "_x.npz", i);
  ImportConfig config;
  config.group = "s([1-3])?";
  import(config);
  EXPECT_EQ(entries().at("s2_x").group, "2");
  EXPECT_EQ(entries().at("s7_x").group, "s7_x");

  existing_ = Existing::replace;
  write_file(in_ / "g.csv", "file,group\ns1_x.npz,pair\ns9_x,pair\n");
  config.group = (in_ / "g.csv").string();
  import(config);
  EXPECT_EQ(entries().at("s1_x").group, "pair");
  EXPECT_EQ(entries().at("s9_x").split, entries().at("s1_x").split);
  EXPECT_EQ(entries().at("s2_x").group, "s2_x");
}

TEST_F(ImportTest, AppendKeepsTheOldSplitsAndClips) {
  for (int i = 0; i < 12; ++i) write("c" + std::to_string(i) + ".npz", i);
  import();
  const auto before = entries();
  EXPECT_THROW(import(), UsageError);
  for (int i = 0; i < 12; ++i) fs::remove(in_ / ("c" + std::to_string(i) + ".npz"));
  write("new/c3.npz", 100);
  write("new/copy.npz", 5);
  existing_ = Existing::append;
  const ImportReport report = import();
  EXPECT_EQ(report.imported, 2u);
  EXPECT_EQ(report.duplicates, (std::vector<std::vector<std::string>>{{"c5", "new_copy"}}));
  const auto after = entries();
  EXPECT_EQ(after.size(), 14u);
  EXPECT_EQ(after.count("new_c3"), 1u);
  for (const auto& [name, entry] : before) EXPECT_EQ(after.at(name).split, entry.split);
  EXPECT_EQ(after.at("new_copy").split, before.at("c5").split);
}

TEST_F(ImportTest, TheSameBytesWithAnyNumberOfThreads) {
  for (int i = 0; i < 9; ++i) write("c" + std::to_string(i) + ".npz", i);
  import();
  const std::string once = read_file(out() / "dataset.json");
  existing_ = Existing::replace;
  threads_ = 1;
  import();
  EXPECT_EQ(read_file(out() / "dataset.json"), once);
}

TEST_F(ImportTest, AlignFloorPutsTheFeetAtZero) {
  write("a.npz", 1, 200);
  ImportConfig config;
  config.align_floor = true;
  import(config);
  const Dataset dataset = load_dataset(out());
  const Clip clip = load_clip(dataset, dataset.entries[0]);
  int under = 0;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    if (std::min({joints(7, 1), joints(8, 1), joints(10, 1), joints(11, 1)}) < -1e-9) ++under;
  }
  EXPECT_EQ(under, 4);  // one frame in fifty may lie lower
}

TEST_F(ImportTest, MistakesOnTheCommandLine) {
  write("a.npz", 1);
  write_file(in_ / "a.c3d", "x");
  ImportJob given = job();
  given.sources = {(in_ / "a.c3d").string()};
  EXPECT_THROW(import_motion({}, given), UsageError);
  given.sources = {(in_ / "none.npz").string()};
  EXPECT_THROW(import_motion({}, given), DataError);
  ImportConfig config;
  config.label_regex = "no named group";
  EXPECT_THROW(import(config), UsageError);
  config = {};
  config.split = "1,1,1";
  EXPECT_THROW(import(config), UsageError);
  config = {};
  config.map = (in_ / "none.json").string();
  EXPECT_THROW(import(config), DataError);
  config = {};
  config.stratify = {"genre"};
  EXPECT_THROW(import(config), UsageError);
  config = {};
  config.drop_first = 12;
  EXPECT_THROW(import(config), DataError);
  given = job();
  given.out = in_.path().parent_path();
  EXPECT_THROW(import_motion({}, given), Error);
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(ImportTest, RetargetingIsMeasured) {
  Random random(3);
  Clip clip = random_clip(random, 10, 60);
  write_bvh(in_ / "a.bvh", clip);
  const ImportReport report = import();
  EXPECT_EQ(report.limbs.table().rows().size(), 8u);
  EXPECT_LT(report.limbs.mean_degrees(), 1e-4);
  EXPECT_TRUE(report_json(report).contains("limb_error_degrees"));
}

TEST(ImportShared, AllSampleFormatsImport) {
  const fs::path formats = fs::path(MOCAPLM_SOURCE_DIR) / "../shared/data/formats";
  if (!fs::exists(formats)) GTEST_SKIP() << "no sample files at " << formats;
  const TemporaryFolder folder;
  ImportJob job;
  job.sources = {formats.string()};
  job.out = folder / "set";
  const ImportReport report = import_motion({}, job);
  EXPECT_EQ(report.imported, 24u);
  EXPECT_TRUE(report.broken.empty());
  EXPECT_FALSE(report.duplicates.empty());  // the variants of salsa_01
}

// A reader whose files hold `parts` motions each, by the digit that ends their name.
std::vector<ReadMotion> read_people(const fs::path& path, const ReadOptions&) {
  const std::string stem = path.stem().string();
  const int parts = stem.back() - '0';
  Random random(std::hash<std::string>()(path.parent_path().filename().string() + stem));
  std::vector<ReadMotion> motions;
  for (int k = 0; k < parts; ++k) {
    ReadMotion motion;
    motion.clip = random_clip(random, 10 + k, 30);
    motion.clip.name = parts > 1 ? stem + "_" + std::string(1, static_cast<char>('1' + k)) : stem;
    motion.report.remarks.push_back({"made up", "is made up"});
    motions.push_back(std::move(motion));
  }
  return motions;
}

TEST_F(ImportTest, AFileOfSeveralMotionsIsAGroupOfClips) {
  for (const char* name :
       {"one/dance3.npz", "one/duo2.npz", "two/solo1.npz", "two/dance3.npz", "two/dance3_1.npz"})
    write(name, 1);
  write_file(in_ / "t.csv", "file,style\none/dance3.npz,salsa\n");
  write_file(in_ / "held.txt", "one/duo2.npz\n");
  ImportConfig config;
  config.label_csv = (in_ / "t.csv").string();
  config.split_list = {"test=" + (in_ / "held.txt").string()};
  std::string first;
  for (const std::int64_t threads : {1, 2, 4}) {
    ImportJob job = this->job();
    job.threads = threads;
    job.read = read_people;
    job.existing = threads == 1 ? Existing::refuse : Existing::replace;
    const ImportReport report = import_motion(config, job);
    EXPECT_EQ(report.imported, 10u);
    EXPECT_EQ(std::count_if(report.remarks.begin(), report.remarks.end(),
                            [](const FileRemark& r) { return r.remark.kind == "made up"; }),
              10);
    const auto all = entries();
    ASSERT_EQ(all.size(), 10u);
    for (const char* part : {"1", "2", "3"}) {
      const DatasetEntry& entry = all.at(std::string("one_dance3_") + part);
      EXPECT_EQ(entry.group, "one_dance3");
      EXPECT_EQ(entry.labels, (Labels{{"style", "salsa"}}));
      EXPECT_EQ(entry.file, "clips/" + entry.name + ".npz");
      EXPECT_EQ(entry.frames, 10 + part[0] - '1');
    }
    EXPECT_EQ(all.at("one_duo2_1").split, "test");
    EXPECT_EQ(all.at("one_duo2_2").split, "test");
    EXPECT_EQ(all.at("two_solo1").group, "two_solo1");
    // A name that another file has is not taken twice.
    EXPECT_EQ(all.at("two_dance3_1").group, "two_dance3_1");
    EXPECT_EQ(all.at("two_dance3_1_2").group, "two_dance3");
    const Dataset dataset = load_dataset(out());
    for (const DatasetEntry& entry : dataset.entries)
      EXPECT_EQ(load_clip(dataset, entry).frames(), entry.frames);
    EXPECT_TRUE(holds_only_a_dataset(out()));
    const std::string json = report_json(report).dump() + read_file(out() / "dataset.json");
    if (first.empty()) first = json;
    EXPECT_EQ(json, first) << threads << " threads";
  }
}

TEST_F(ImportTest, TheSameTroubleIsOneLine) {
  for (int i = 0; i < 40; ++i)
    write_file(in_ / ("bad" + std::to_string(i) + ".npz"),
               "version https://git-lfs.github.com/spec/v1\n");
  write_file(in_ / "empty.npz", "");
  write("good1.npz", 1);
  write("good1b.npz", 2);
  ImportJob job = this->job();
  job.read = [](const fs::path& path, const ReadOptions& options) {
    std::vector<ReadMotion> motions = read_clips(path, options);
    motions[0].report.remarks.push_back({"guessed", "is guessed of " + path.stem().string()});
    return motions;
  };
  const ImportReport report = import_motion({}, job);
  EXPECT_EQ(report.broken.size(), 41u);
  const auto left_out = left_out_lines(report);
  ASSERT_EQ(left_out.size(), 2u);
  EXPECT_EQ(
      left_out[0].find("40 files for the same reason; for example " + report.broken[0].reason), 0u);
  EXPECT_NE(left_out[1].find("empty.npz: is empty"), std::string::npos);
  EXPECT_EQ(report_json(report)["broken"].size(), 41u);
  EXPECT_EQ(remark_lines(report)[0].find("2 files: guessed; for example "), 0u);
  EXPECT_EQ(report_json(report)["remarks"].size(), report.remarks.size());
}

TEST_F(ImportTest, ReadersAreToldWhatTheCommandWas) {
  write("a.npz", 1);
  ImportConfig config;
  config.up = "z";
  config.unit = 0.0254;
  config.keep_path = config.fill_gaps = true;
  config.body = "smpl.npz";
  config.fps = 50;
  config.drop_first = 3;
  ImportJob job = this->job();
  job.read = [](const fs::path& path, const ReadOptions& options) {
    EXPECT_EQ(options.up, up_axis_of("z"));
    EXPECT_EQ(options.unit, 0.0254);
    EXPECT_TRUE(options.keep_path && options.fill_gaps);
    EXPECT_EQ(options.body, "smpl.npz");
    EXPECT_EQ(options.fps, 50);
    EXPECT_EQ(options.drop_first, 3);
    return read_clips(path);
  };
  import_motion(config, job);
  const Json stored = load_dataset(out()).import;
  EXPECT_EQ(stored.at("unit"), 0.0254);
  EXPECT_EQ(stored.at("fill_gaps"), true);
  EXPECT_EQ(stored.at("body"), "smpl.npz");
}

}  // namespace
}  // namespace mocaplm::import_test
