// What readers remark, how often it is told, and the options of reading by name.
#include "motion/reading.h"

#include <gtest/gtest.h>

#include <thread>

#include "support/refusal.h"

namespace mocaplm::reading_test {
namespace {

TEST(Remarks, EachKindIsToldOnce) {
  Remarks remarks;
  EXPECT_TRUE(remarks.sentences().empty());
  remarks.add("b.bvh", {{"rate", "0.033 is taken for 30 frames a second"}});
  remarks.add("a.bvh",
              {{"unit", "inches"}, {"unit", "inches"}, {"frames", "announced 9, found 8"}});
  const std::vector<std::string> lone = remarks.sentences();
  ASSERT_EQ(lone.size(), 3u);
  EXPECT_EQ(lone[0], "a.bvh: announced 9, found 8.");
  EXPECT_EQ(lone[1], "b.bvh: 0.033 is taken for 30 frames a second.");
  EXPECT_EQ(lone[2], "a.bvh: inches.");
}

// Whatever thread comes first, the same example is named.
TEST(Remarks, ManyFilesGiveACountAndAnExample) {
  Remarks remarks;
  std::vector<std::thread> threads;
  for (int t = 3; t >= 0; --t)
    threads.emplace_back([&remarks, t] {
      for (int i = t; i < 200; i += 4)
        remarks.add(std::to_string(1000 + i) + ".bvh",
                    {{"frames", "announced " + std::to_string(i)}});
    });
  for (std::thread& thread : threads) thread.join();
  ASSERT_EQ(remarks.sentences().size(), 1u);
  EXPECT_EQ(remarks.sentences()[0], "200 files, 1000.bvh among them: announced 0.");
}

TEST(ReadOptions, AreNamedAsTheCommandLineDoes) {
  ReadOptions options;
  EXPECT_TRUE(given_options(options).empty());
  refuse_read_options(options, " is not for this");
  options.up = UpAxis::z;
  options.drop_first = 3;
  EXPECT_EQ(given_options(options), (std::vector<std::string>{"--up", "--drop-first"}));
  EXPECT_EQ(refusal<UsageError>([&] { refuse_read_options(options, " is not for this"); }),
            "--up is not for this");
  options.fps = 60;
  options.unit = 1;
  options.bvh_map = "m.json";
  options.keep_path = options.fill_gaps = true;
  options.body = "body.npz";
  EXPECT_EQ(given_options(options).size(), 8u);
}

TEST(Units, AreNamesOrMetres) {
  EXPECT_EQ(metres_of_unit("m"), 1);
  EXPECT_EQ(metres_of_unit("cm"), 0.01);
  EXPECT_EQ(metres_of_unit("mm"), 0.001);
  EXPECT_EQ(metres_of_unit("in"), 0.0254);
  EXPECT_DOUBLE_EQ(metres_of_unit("ft"), 12 * metres_of_unit("in"));
  EXPECT_EQ(metres_of_unit("0.05644"), 0.05644);
  EXPECT_EQ(metres_of_unit("1e-6"), 1e-6);
  for (const char* bad : {"", "0", "-1", "nan", "inf", "1e7", "cm2", "inch", "1 m"})
    EXPECT_TRUE(contains(refusal<UsageError>([&] { metres_of_unit(bad); }), "m, cm, mm, in, ft"))
        << bad;
}

}  // namespace
}  // namespace mocaplm::reading_test
