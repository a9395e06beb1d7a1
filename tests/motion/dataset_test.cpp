#include "motion/dataset.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/dataset_write.h"
#include "motion/helpers.h"

namespace fs = std::filesystem;

namespace mocaplm {
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
  expect_refused("\"version\": 1", "\"version\": 2", "version");
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
}  // namespace mocaplm
