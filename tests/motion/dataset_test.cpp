#include "motion/dataset.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/dataset_write.h"
#include "motion/helpers.h"

namespace fs = std::filesystem;

namespace mocaplm::dataset_test {
namespace {

// Writes clips of the given names; all in train.
Dataset write_some(const fs::path& out, const std::vector<std::string>& names,
                   Existing existing = Existing::refuse) {
  Dataset written;
  write_dataset(out, existing, [&](const fs::path& directory) {
    Random random(5);
    for (const std::string& name : names) {
      Clip clip = random_clip(random, 7, 30);
      DatasetEntry entry{name, clip_file(name), clip.frames(),   clip.fps, {{"style", "happy"}},
                         name, "train",         "made by a test"};
      store_clip(directory, entry, clip);
      written.entries.push_back(entry);
    }
    return written;
  });
  return written;
}

TEST(Dataset, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  write_some(folder / "d", {"walk", "bow", "übung"});
  const Dataset read = load_dataset(folder / "d");
  ASSERT_EQ(read.entries.size(), 3u);
  EXPECT_EQ(read.entries[0].name, "bow");
  EXPECT_EQ(read.entries[1].labels.at("style"), "happy");
  EXPECT_EQ(read.entries[1].frames, 7);
  EXPECT_FALSE(read.procedural);
  for (const DatasetEntry& entry : read.entries) EXPECT_EQ(read.find(entry.name), &entry);
  for (const char* unknown : {"", "a", "dance", "walk2"}) EXPECT_EQ(read.find(unknown), nullptr);
  EXPECT_EQ(read.split("train").size(), 3u);
  EXPECT_EQ(read.split("test").size(), 0u);
  EXPECT_EQ(read.label_names(), std::vector<std::string>{"style"});
  EXPECT_EQ(read.label_values("style"), std::vector<std::string>{"happy"});
  const Clip clip = load_clip(read, read.entries[0]);
  EXPECT_EQ(clip.name, "bow");
  EXPECT_EQ(clip.frames(), 7);
  EXPECT_EQ(clip.labels.at("style"), "happy");
}

// Replaces `from` by `to` in dataset.json and expects an error that speaks of `part`.
void expect_refused(const std::string& from, const std::string& to, const std::string& part) {
  const TemporaryFolder folder;
  write_some(folder / "d", {"a", "b"});
  const fs::path file = folder / "d" / "dataset.json";
  std::string text = read_file(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  write_file(file, text.replace(at, from.size(), to));
  try {
    load_dataset(folder / "d");
    FAIL() << "accepted " << to;
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("dataset.json"), std::string::npos) << error.what();
  }
}

TEST(Dataset, RefusesWhatIsNotSound) {
  expect_refused("\"version\": 2", "\"version\": 3", "version");
  expect_refused("mocaplm dataset", "something", "format");
  expect_refused("\"procedural\": false", "\"procedural\": 0", "true or false");
  expect_refused("\"name\":\"a\"", "\"name\":\"b\"", "more than once");
  expect_refused("\"name\":\"a\"", "\"name\":\"x/a\"", "not a clip name");
  expect_refused("\"name\":\"a\"", "\"nome\":\"a\"", "did you mean");
  expect_refused("clips/a.npz", "clips/b.npz", "more than once");
  expect_refused("clips/a.npz", "../a.npz", "leaves the dataset");
  expect_refused("clips/a.npz", "clips/../../a.npz", "leaves the dataset");
  expect_refused("clips/a.npz", "/etc/passwd", "leaves the dataset");
  expect_refused("clips/a.npz", "", "leaves the dataset");
  expect_refused("\"frames\":7", "\"frames\":0", "frames");
  expect_refused("\"frames\":7", "\"frames\":7.5", "whole number");
  expect_refused("\"fps\":30.0", "\"fps\":0", "fps");
  expect_refused("\"fps\":30.0", "\"fps\":1e99", "fps");
  expect_refused("\"split\":\"train\"", "\"split\":\"trian\"", "trian");
  expect_refused("\"style\":\"happy\"", "\"style\":3", "style");
  expect_refused("\"source\":", "\"extra\":1,\"source\":", "extra");
  expect_refused("\"clips\": [", "\"clips\": 3, \"x\": [", "list of clips");
}

TEST(Dataset, ALinkOutOfTheFolderIsRefused) {
  const TemporaryFolder folder;
  write_some(folder / "d", {"a"});
  fs::rename(folder / "d" / "clips" / "a.npz", folder / "a.npz");
  fs::create_symlink("../../a.npz", folder / "d" / "clips" / "a.npz");
  EXPECT_THROW(load_dataset(folder / "d"), DataError);
}

TEST(Dataset, AClipMustBeWhatTheListSays) {
  const TemporaryFolder folder;
  write_some(folder / "d", {"a"});
  const Dataset dataset = load_dataset(folder / "d");
  DatasetEntry entry = dataset.entries[0];
  entry.frames = 8;
  EXPECT_THROW(load_clip(dataset, entry), DataError);
  entry = dataset.entries[0];
  entry.fps = 31;
  EXPECT_THROW(load_clip(dataset, entry), DataError);
  fs::remove(folder / "d" / "clips" / "a.npz");
  EXPECT_THROW(load_clip(dataset, dataset.entries[0]), DataError);
}

TEST(Dataset, MissingFoldersAndFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(load_dataset(folder / "none"), DataError);
  EXPECT_THROW(load_dataset(folder.path()), DataError);
  write_file(folder / "file", "x");
  EXPECT_THROW(load_dataset(folder / "file"), DataError);
}

// A dataset of one clip as an older version wrote it.
fs::path old_dataset(const TemporaryFolder& folder, const std::string& source) {
  write_some(folder / "old", {"a"});
  const fs::path file = folder / "old" / "dataset.json";
  std::string text = read_file(file);
  text.replace(text.find("\"version\": 2"), 12, "\"version\": 1");
  text.replace(text.find("made by a test"), 14, source);
  write_file(file, text);
  return folder / "old";
}

TEST(Dataset, OldOnesOfAmassFilesAreToBeImportedAgain) {
  const TemporaryFolder folder;
  const fs::path old = old_dataset(folder, "mocap/Walk.NPZ");
  for (int twice = 0; twice < 2; ++twice) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(load_dataset(old).version, 1);
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(said.find("import them again") != std::string::npos, twice == 0) << said;
  }
  // Clips that are added leave the old ones as they are, and the warning with them.
  write_dataset(old, Existing::append, [&](const fs::path& directory) {
    Dataset both = read_dataset(old);
    Random random(9);
    const Clip clip = random_clip(random, 7, 30);
    const DatasetEntry entry{"b", clip_file("b"), 7, 30, {}, "b", "train", "b.bvh"};
    store_clip(directory, entry, clip);
    both.entries.push_back(entry);
    both.version = kDatasetVersion;
    return both;
  });
  EXPECT_NE(dataset_trouble(read_dataset(old)).find("1 of 2"), std::string::npos);
  write_some(old, {"c"}, Existing::replace);
  EXPECT_EQ(dataset_trouble(read_dataset(old)), "");
}

TEST(Dataset, OldOnesOfOtherFilesAreAsGoodAsNew) {
  const TemporaryFolder folder;
  EXPECT_EQ(dataset_trouble(read_dataset(old_dataset(folder, "walk.bvh"))), "");
  const TemporaryFolder other;
  EXPECT_EQ(dataset_trouble(read_dataset(old_dataset(other, "gWA_sBM_cAll_d26_mWA2_ch03.pkl"))),
            "");
}

TEST(DatasetWrite, NeverCostsWhatWasThere) {
  const TemporaryFolder folder;
  write_some(folder / "d", {"a"});
  const std::string before = read_file(folder / "d" / "dataset.json");
  EXPECT_THROW(write_some(folder / "d", {"b"}), UsageError);
  EXPECT_EQ(read_file(folder / "d" / "dataset.json"), before);

  // A failure on the way leaves the old one.
  EXPECT_THROW(
      write_dataset(folder / "d", Existing::replace,
                    [](const fs::path&) -> Dataset { throw DataError(in_file("x"), "no"); }),
      DataError);
  EXPECT_EQ(read_file(folder / "d" / "dataset.json"), before);

  // Something that is not the dataset's.
  write_file(folder / "d" / "notes.txt", "mine");
  EXPECT_THROW(write_some(folder / "d", {"b"}, Existing::replace), DataError);
  EXPECT_THROW(write_some(folder / "d", {"b"}, Existing::append), DataError);
  EXPECT_EQ(read_file(folder / "d" / "notes.txt"), "mine");
  fs::remove(folder / "d" / "notes.txt");

  write_some(folder / "d", {"b"}, Existing::replace);
  EXPECT_EQ(load_dataset(folder / "d").entries[0].name, "b");
  EXPECT_FALSE(fs::exists(folder / "d" / "clips" / "a.npz"));

  write_file(folder / "other" / "notes.txt", "mine");
  EXPECT_THROW(write_some(folder / "other", {"b"}, Existing::replace), DataError);
  write_file(folder / "file", "mine");
  EXPECT_THROW(write_some(folder / "file", {"b"}, Existing::replace), DataError);
  EXPECT_EQ(read_file(folder / "file"), "mine");
}

}  // namespace
}  // namespace mocaplm::dataset_test
