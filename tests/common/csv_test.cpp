#include "common/csv.h"

#include <gtest/gtest.h>

#include "common/error.h"

namespace mocaplm::csv_test {
namespace {

using Row = std::vector<std::string>;

TEST(Csv, ReadsPlainAndQuotedCells) {
  const Csv csv = parse_csv(
      "\xEF\xBB\xBF"
      "file,style,note\r\n"
      "a.bvh,happy,\r\n"
      "\r\n"
      "\"b,c.bvh\",\"said \"\"no\"\"\",\"two\nlines\"\n"
      "d,,e",
      "t.csv");
  EXPECT_EQ(csv.columns, (Row{"file", "style", "note"}));
  ASSERT_EQ(csv.rows.size(), 3u);
  EXPECT_EQ(csv.rows[0], (Row{"a.bvh", "happy", ""}));
  EXPECT_EQ(csv.rows[1], (Row{"b,c.bvh", "said \"no\"", "two\nlines"}));
  EXPECT_EQ(csv.rows[2], (Row{"d", "", "e"}));
  EXPECT_EQ(csv.lines, (std::vector<std::size_t>{2, 4, 6}));
  EXPECT_EQ(csv.find("style"), 1);
  EXPECT_EQ(csv.find("colour"), -1);
}

void expect_error(const std::string& text, const std::string& part) {
  try {
    parse_csv(text, "t.csv");
    FAIL() << "accepted: " << text;
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Csv, NamesTheLineOfWhatIsWrong) {
  expect_error("", "empty");
  expect_error("\n\n", "empty");
  expect_error("a,b\n1,2\n3\n", "line 3");
  expect_error("a,b\n1,2,3\n", "has 3 cells");
  expect_error("a,a\n", "twice");
  expect_error("a,\n", "no name");
  expect_error("a,b\n1,\"2\n", "line 2");
  expect_error("a,b\n\"1\"x,2\n", "after a closing quote");
}

TEST(Csv, ColumnSuggestsTheNearest) {
  const Csv csv = parse_csv("file,style\n", "t.csv");
  try {
    csv.column("stile");
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"style\""), std::string::npos);
  }
}

}  // namespace
}  // namespace mocaplm::csv_test
