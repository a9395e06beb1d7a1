#include "motion/import/troubles.h"

#include <gtest/gtest.h>

namespace mocaplm::troubles_test {
namespace {

using Lines = std::vector<std::string>;

TEST(Troubles, TheSameErrorInOtherFilesIsOfOneKind) {
  const std::vector<std::pair<std::string, std::string>> same = {
      {"a/1.bvh",
       "a/1.bvh: line 5, frame 12, joint Left Arm, Xrotation: found \"nan\", expected 9"},
      {"b.bvh", "b.bvh: line 77, frame 0, joint Hips, Zposition: found \"1.#IND\", expected -9.5"}};
  EXPECT_EQ(kind_of_error(same[0].second, same[0].first),
            kind_of_error(same[1].second, same[1].first));
  EXPECT_NE(kind_of_error("b.bvh: is empty", "b.bvh"),
            kind_of_error("b.bvh: has no frames", "b.bvh"));
  EXPECT_NE(kind_of_error("b.bvh: found \"x\"", "b.bvh"), kind_of_error("b.bvh: found y", "b.bvh"));
  EXPECT_EQ(kind_of_error("an unfinished \"quote", "x"), "an unfinished \"quote");
}

TEST(Troubles, OneLineAKindWithACountAndAnExample) {
  Troubles troubles;
  EXPECT_TRUE(troubles.empty());
  for (int i = 0; i < 75; ++i)
    EXPECT_EQ(troubles.add({std::to_string(i) + ".bvh",
                            {"frames announced", "announces " + std::to_string(i)}}),
              i == 0);
  EXPECT_TRUE(troubles.add({"0.bvh", {"named End Sites", "has names"}}));
  EXPECT_FALSE(troubles.add({"0.bvh", {"named End Sites", "has more"}}));  // of the same file
  EXPECT_EQ(troubles.lines(), (Lines{"75 files: frames announced; for example 0.bvh: announces 0",
                                     "0.bvh: has names"}));
  Troubles errors;
  errors.add({"a", {"k", "a: is empty"}});
  errors.add({"b", {"k", "b: is empty"}});
  errors.add({"c", {"l", "c: is no file"}});
  EXPECT_EQ(errors.error_lines(),
            (Lines{"2 files for the same reason; for example a: is empty", "c: is no file"}));
}

}  // namespace
}  // namespace mocaplm::troubles_test
