// What a table looks like on a terminal.
#include "common/table.h"

#include <gtest/gtest.h>

#include "common/text.h"

namespace mocaplm::table_test {
namespace {

TEST(Table, AlignsTheFirstColumnLeftAndTheOthersRight) {
  Table table("Clips", {"split", "clips"});
  table.row({"train", 8});
  table.row({"test", 10});
  table.note("of two folders");
  EXPECT_EQ(table.text(),
            "Clips\n"
            "split  clips\n"
            "-----  -----\n"
            "train      8\n"
            "test      10\n"
            "of two folders\n");
}

TEST(Table, FoldsALongTextOfTheLastColumn) {
  Table table("", {"what", "value"});
  std::string list;
  for (int i = 0; i < 60; ++i) list += (i ? ", " : "") + std::string("tensor") + std::to_string(i);
  table.row({"tensors", list});
  table.row({"bytes", 12});
  const std::vector<std::string> lines = split(table.text(), '\n');
  std::string words;
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 100u) << line;
    if (line.rfind("tensors  ", 0) == 0 || line.rfind("         tensor", 0) == 0)
      words += (words.empty() ? "" : " ") + line.substr(9);
  }
  EXPECT_EQ(words, list);
  // The short values of a folded column begin where the long ones do.
  EXPECT_NE(table.text().find("\nbytes    12\n"), std::string::npos) << table.text();
  EXPECT_EQ(table.json()["rows"][0]["value"].get<std::string>(), list);
}

TEST(Table, LeavesAWordWhole) {
  Table table("", {"what", "value"});
  const std::string path = "/" + std::string(150, 'x');
  table.row({"file", path});
  table.row({"size", "1 MB"});
  EXPECT_NE(table.text().find("file  " + path + "\n"), std::string::npos) << table.text();
  // Nothing was folded, so that values stay on the right.
  EXPECT_NE(table.text().find(" 1 MB\n"), std::string::npos) << table.text();
}

}  // namespace
}  // namespace mocaplm::table_test
