#include <gtest/gtest.h>

#include <cmath>

#include "motion/formats/position_helpers.h"

namespace mocaplm::trc_test {
namespace {

TEST(Trc, JointCentresComeIn) {
  const Scratch folder;
  const Clip clip = dance();
  std::vector<std::pair<int, std::string>> smpl;
  for (int j = 0; j < 24; ++j)
    smpl.emplace_back(j, "Actor:" + joint_names()[static_cast<std::size_t>(j)]);
  for (const auto& [unit, scale] : {std::pair{"m", 1.0}, std::pair{"mm", 1000.0}}) {
    ReadReport report;
    Clip read = read_clip(folder.put("a.trc", trc_of(clip, smpl, unit, scale)), {}, &report);
    EXPECT_EQ(read.fps, 60);
    EXPECT_LT(worst_distance(read, clip, 24), 1e-4);
    EXPECT_TRUE(has_remark(report, "up axis", "z is up"));
    EXPECT_FALSE(has_remark(report, "unit"));
    read = read_clip(folder.put("b.trc", trc_of(clip, open_pose_names(), unit, scale)));
    EXPECT_LT(std::abs(joint_positions(read, 9)(7, 1) - joint_positions(clip, 9)(7, 1)), 1e-3);
  }
  ReadReport report;
  const Clip read =
      read_clip(folder.put("c.trc", trc_of(clip, smpl, "m", 1000, "100")), {}, &report);
  EXPECT_EQ(read.fps, 60);
  EXPECT_TRUE(has_remark(report, "frame rate", "100"));
  EXPECT_TRUE(has_remark(report, "unit", "millimetres"));
}

// Names without empty columns between them, no line before the data, cells missing at the end of a
// row, tabs at the end of lines, wrong counts.
TEST(Trc, FilesOfManyWritersComeIn) {
  const Scratch folder;
  const Clip clip = dance();
  const std::string whole = trc_of(clip, open_pose_names(), "mm", 1000);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  const Clip truth = read_clip(folder.put("a.trc", whole));
  for (const std::string& text :
       {changed("\t\t\t", "\t"), changed("\r\n\r\n", "\n"), changed("\r\n", "\t\r\n"),
        changed("\r\n", "\r"), changed("\tmm\t", "\tMM\t"), "\xEF\xBB\xBF" + whole}) {
    const Clip read = read_clip(folder.put("b.trc", text));
    EXPECT_LT(worst_distance(read, truth), 1e-9);
  }
  ReadReport report;
  read_clip(folder.put("c.trc", changed("\t120\t15\t", "\t500\t16\t")), {}, &report);
  EXPECT_TRUE(has_remark(report, "frames announced", "500"));
  EXPECT_TRUE(has_remark(report, "markers announced", "16"));
  // The last wrist of a frame is not there.
  std::string text = whole;
  const std::size_t line = text.find("\r\n51\t") + 2, end = text.find("\r\n", line);
  std::size_t cut = end;
  for (int i = 0; i < 3; ++i) cut = text.rfind('\t', cut - 1);
  text.erase(cut, end - cut);
  const std::string refused = refusal([&] { read_clip(folder.put("d.trc", text)); });
  EXPECT_TRUE(contains(refused, "frame 50") && contains(refused, "left_wrist")) << refused;
}

TEST(Trc, SkinMarkersAreCalledThat) {
  const Scratch folder;
  const Clip clip = dance();
  std::vector<std::pair<int, std::string>> markers;
  for (const char* name : {"C7", "T10", "CLAV", "LASI", "RASI", "LKNE", "RKNE", "LANK", "RANK"})
    markers.emplace_back(3, name);
  const auto path = folder.put("a.trc", trc_of(clip, markers, "mm", 1000));
  EXPECT_TRUE(contains(refusal([&] { read_clip(path); }), "markers on the skin"));
  markers = {{1, "LHip"}, {2, "RHip"}, {4, "LKnee"}};
  const std::string text =
      refusal([&] { read_clip(folder.put("b.trc", trc_of(clip, markers, "m", 1))); });
  EXPECT_TRUE(contains(text, "right_knee") && contains(text, "left_wrist")) << text;
}

}  // namespace
}  // namespace mocaplm::trc_test
