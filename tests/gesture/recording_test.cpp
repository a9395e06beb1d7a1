#include "gesture/recording.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace mocaplm::recording_test {
namespace {

class Recorded : public ::testing::Test {
 protected:
  Recordings read(const std::string& text, const std::vector<std::string>& coordinates = {},
                  const std::vector<std::string>& conditions = {"start", "end"}) {
    write_file(folder_ / "hand.csv", text);
    return read_recordings({folder_ / "hand.csv"}, coordinates, conditions);
  }
  void refused(const std::string& text, const std::string& part) {
    const std::string message = refusal([&] { read(text); });
    EXPECT_PRED2(contains, message, part);
    EXPECT_PRED2(contains, message, "hand.csv");
  }
  TemporaryFolder folder_;
};

TEST_F(Recorded, ReadsWhatTheColumnsSay) {
  const Recordings all = read(
      "trajectory,time,x,event,y,ball\n"
      "a,0,1,,2,9\na,0.5,1.5,toss,2.5,8\n"
      "b,3,-1e-3,,+4, 7 \nb,4,0,,5,6\nb,5,1,,6,5\n",
      {}, {"start", "ball", "duration"});
  EXPECT_EQ(all.coordinates, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(all.more, (std::vector<std::string>{"ball"}));
  ASSERT_EQ(all.all.size(), 2u);
  EXPECT_EQ(all.all[0].name, "a");
  EXPECT_EQ(all.all[0].events[1], "toss");
  EXPECT_TRUE(all.all[0].phases.empty());
  EXPECT_EQ(all.all[1].time.size(), 3);
  EXPECT_EQ(all.all[1].values(0, 0), -1e-3);
  EXPECT_EQ(all.all[1].values(0, 1), 4);
  EXPECT_EQ(all.all[1].more(0, 0), 7);
  EXPECT_EQ(read("time,x\n0,1\n1,2\n").all[0].name, "hand") << "of the file";
  EXPECT_EQ(read("time,x,y\n0,1,5\n1,2,5\n", {"y"}).all[0].values(1, 0), 5);
}

TEST_F(Recorded, WhatIsWrittenIsReadAgain) {
  const Recordings all = read("trajectory,time,x,event\na,0,0.1,\na,0.25,1e-17,catch\n");
  const Recordings again = read(recordings_csv(all));
  EXPECT_EQ(again.coordinates, all.coordinates);
  EXPECT_EQ(again.all[0].time, all.all[0].time);
  EXPECT_EQ(again.all[0].values, all.all[0].values);
  EXPECT_EQ(again.all[0].events, all.all[0].events);
}

TEST_F(Recorded, RefusesWhatIsBroken) {
  refused("", "is empty");
  refused("time,x\n", "no rows");
  refused("t,x\n0,1\n1,2\n", "no column \"time\"");
  refused("time\n0\n1\n", "no column that could be a coordinate");
  refused("time,x\n0,1\n", "one sample");
  refused("trajectory,time,x\na,0,1\nb,0,1\nb,1,2\n", "trajectory \"a\" has one sample");
  refused("trajectory,time,x\na,0,1\na,1,1\nb,0,1\nb,1,2\na,2,0\na,3,1\n", "stand together");
  refused("time,x\n0,1\n0,2\n", "line 3: time 0 s");
  refused("time,x\n0,1\n1,2\n0.5,2\n", "line 4");
  for (const char* cell : {"nan", "inf", "", "1,5", "one", "1e999", "0x10", "1 2", "--1"}) {
    const std::string quoted = "\"" + std::string(cell) + "\"";
    refused("time,x\n0,1\n1," + quoted + "\n", "line 3: column \"x\": expected a finite number");
  }
  refused("time,x\n0,1\n1\n", "line 3");
  refused("time,x\n0,\"1\n", "quote");
  EXPECT_PRED2(contains, refusal([&] { read("time,x\n0,1\n1,2\n", {"z"}); }), "no column \"z\"");
  EXPECT_PRED2(contains, refusal([&] { read("time,x\n0,1\n1,2\n", {}, {"bal"}); }),
               "no column \"bal\"");
  EXPECT_THROW(read_recordings({}, {}, {}), UsageError);
  EXPECT_THROW(read_recordings({folder_ / "none.csv"}, {}, {}), DataError);
}

TEST_F(Recorded, FilesHaveNamesOfTheirOwn) {
  write_file(folder_ / "a.csv", "time,x\n0,1\n1,2\n");
  write_file(folder_ / "b.csv", "time,x\n0,1\n1,2\n");
  const Recordings all = read_recordings({folder_ / "a.csv", folder_ / "b.csv"}, {}, {});
  EXPECT_EQ(all.all.size(), 2u);
  EXPECT_THROW(read_recordings({folder_ / "a.csv", folder_ / "a.csv"}, {}, {}), DataError);
}

}  // namespace
}  // namespace mocaplm::recording_test
