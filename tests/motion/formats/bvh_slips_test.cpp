// Slips of a header or a last line that leave no doubt of the motion are read and said; the others
// are refused by what they are.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/error.h"
#include "motion/formats/bvh.h"
#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "support/refusal.h"

namespace mocaplm::bvh_slips_test {
namespace {

const char* const kHierarchy =
    "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 0 0\n\tCHANNELS 3 Xposition Yposition Zposition\n"
    "\tJOINT Arm\n\t{\n\t\tOFFSET 0 5 0\n\t\tCHANNELS 1 Xrotation\n"
    "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 1 0\n\t\t}\n\t}\n}\n";

// `lines` frames, line t being "t 0 1 -t".
std::string text_of(const std::string& frames, int lines,
                    const std::string& time = "Frame Time: 0.04") {
  std::string text = std::string(kHierarchy) + "MOTION\n" + frames + "\n" + time + "\n";
  for (int t = 0; t < lines; ++t) text += std::to_string(t) + " 0 1 -" + std::to_string(t) + "\n";
  return text;
}

void expect_frames(const Bvh& bvh, int frames) {
  ASSERT_EQ(bvh.frames(), frames);
  for (int t = 0; t < frames; ++t) {
    EXPECT_EQ(bvh.values(t, 0), t);
    EXPECT_EQ(bvh.values(t, 2), 1);
    EXPECT_EQ(bvh.values(t, 3), -t);
  }
}

std::vector<std::string> kinds(const Bvh& bvh) {
  std::vector<std::string> all;
  for (const Remark& remark : bvh.remarks) all.push_back(remark.kind);
  return all;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

using Kinds = std::vector<std::string>;

TEST(BvhSlips, AnyNumberOfFramesMayBeAnnounced) {
  for (const int lines : {1, 2, 5, 40, 400})
    for (const int announced : {0, 1, 3, 5, 39, 41, 400, 401, 5000}) {
      const Bvh bvh = parse_bvh(text_of("Frames: " + std::to_string(announced), lines), "f");
      SCOPED_TRACE(std::to_string(lines) + " of " + std::to_string(announced));
      expect_frames(bvh, lines);
      EXPECT_EQ(kinds(bvh), lines == announced ? Kinds{} : Kinds{"frames announced"});
      if (lines != announced) {
        EXPECT_NE(bvh.remarks[0].text.find("announces " + std::to_string(announced)),
                  std::string::npos);
        EXPECT_NE(bvh.remarks[0].text.find(std::to_string(lines) + " whole frame"),
                  std::string::npos);
        // That motion may be lost is said where much is missing.
        EXPECT_EQ(bvh.remarks[0].text.find("may be lost") != std::string::npos,
                  announced - lines > 3 && announced - lines > announced / 100);
      }
    }
}

TEST(BvhSlips, WithoutALastLineEndAllIsRead) {
  for (const int announced : {39, 40, 41}) {
    std::string text = text_of("Frames: " + std::to_string(announced), 40);
    text.pop_back();
    expect_frames(parse_bvh(text, "f"), 40);
    expect_frames(parse_bvh(text + "\r\n\n \t\n\x1A", "f"), 40);
  }
}

TEST(BvhSlips, OfAFileThatWasCutTheLastLineIsLeftOutOrAllRefused) {
  const std::string line = "40 0 1 -40";
  // After each byte behind which something must follow.
  for (const std::size_t bytes : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    const std::string cut = line.substr(0, bytes);
    const Bvh bvh = parse_bvh(text_of("Frames: 41", 40) + cut, "f");
    expect_frames(bvh, 40);
    EXPECT_EQ(kinds(bvh), (Kinds{"last line cut short", "frames announced"})) << cut;
    const std::string message = refusal([&] { parse_bvh(text_of("Frames: 100", 40) + cut, "f"); });
    EXPECT_NE(message.find("f: line 59, frame 40: the file is cut short"), std::string::npos)
        << message;
    EXPECT_NE(message.find("40 whole frames of 100"), std::string::npos) << message;
  }
  // In the middle of the text a short line is no cut.
  EXPECT_NE(refusal([&] {
              parse_bvh(text_of("Frames: 41", 40) + "40 0\n41 0 1 -41\n", "f");
            }).find("line 59, frame 40: the line ends after 2 of 4 values"),
            std::string::npos);
  // Words at the end are not half a number.
  EXPECT_NE(refusal([&] {
              parse_bvh(text_of("Frames: 40", 40) + "HIERARCHY", "f");
            }).find("goes on after the 40 frames"),
            std::string::npos);
}

TEST(BvhSlips, NoFramesAtAllAreRefused) {
  for (const std::string frames : {"Frames: 0", "Frames: 3"})
    EXPECT_NE(refusal([&] { parse_bvh(text_of(frames, 0), "f"); }).find("has no frames"),
              std::string::npos);
}

TEST(BvhSlips, HeadersInAnyCaseAndSpacing) {
  for (const std::string frames :
       {"Frames: 7", "frames:7", "FRAMES :\t7", "Frames 7", "\n\nFrames:\n7"})
    for (const std::string time : {"Frame Time: 0.04", "Frame Time:0.04", "FrameTime: .04",
                                   "frametime:0.04", "FRAME\tTIME\t:\t4e-2", "Frame  Time 0.04"}) {
      const Bvh bvh = parse_bvh(replaced(text_of(frames, 7, time), "MOTION", "Motion"), "f");
      SCOPED_TRACE(frames + " / " + time);
      expect_frames(bvh, 7);
      EXPECT_EQ(bvh.fps, 25);
      EXPECT_TRUE(bvh.remarks.empty());
    }
}

TEST(BvhSlips, BlankLinesTabsAndCarriageReturnsBetweenFrames) {
  std::string text = text_of("Frames: 9", 9);
  const std::size_t motion = text.find("0.04") + 5;
  text = text.substr(0, motion) +
         replaced(replaced(text.substr(motion), "\n", " \t\r\n\r\n\n"), " ", "\t ");
  const Bvh bvh = parse_bvh(text, "f");
  expect_frames(bvh, 9);
  EXPECT_TRUE(bvh.remarks.empty());
}

TEST(BvhSlips, EndSitesMayHaveNames) {
  const Bvh plain = parse_bvh(text_of("Frames: 2", 2), "f");
  for (const std::string end : {"End Site Arm_end", "End Site_foo", "end site", "End Effector",
                                "End SiteArm", "EndSite", "End_Site x", "END SITE {"}) {
    std::string text = text_of("Frames: 2", 2);
    text = end.back() == '{' ? replaced(text, "End Site\n\t\t{", end)
                             : replaced(text, "End Site", end);
    const Bvh bvh = parse_bvh(text, "f");
    SCOPED_TRACE(end);
    ASSERT_EQ(bvh.joints.size(), 2u);
    ASSERT_EQ(bvh.joints[1].end_sites.size(), 1u);
    EXPECT_EQ(bvh.joints[1].end_sites[0], plain.joints[1].end_sites[0]);
    EXPECT_EQ(bvh.values, plain.values);
    EXPECT_EQ(kinds(bvh),
              end == "end site" || end.back() == '{' ? Kinds{} : Kinds{"named End Sites"});
  }
}

TEST(BvhSlips, JointsOfOneNameAreKeptApartAndSaid) {
  const std::string limb = "JOINT Arm\n{\nOFFSET 1 0 0\nCHANNELS 1 Zrotation\n}\n";
  const std::string text = "HIERARCHY\nROOT Arm\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + limb +
                           "JOINT Arm_3\n{\nOFFSET 2 0 0\n}\n" + limb + limb +
                           "}\nMOTION\nFrames: 1\nFrame Time: 0.04\n1 2 3 4\n";
  const Bvh bvh = parse_bvh(text, "f");
  std::vector<std::string> names;
  for (const BvhJoint& joint : bvh.joints) names.push_back(joint.name);
  EXPECT_EQ(names, (std::vector<std::string>{"Arm", "Arm_2", "Arm_3", "Arm_4", "Arm_5"}));
  EXPECT_EQ(kinds(bvh), Kinds{"doubled joint names"});
  EXPECT_NE(bvh.remarks[0].text.find("3 joints"), std::string::npos) << bvh.remarks[0].text;
  EXPECT_NE(bvh.remarks[0].text.find("\"Arm_2\""), std::string::npos);
}

TEST(BvhSlips, WhatCannotBeReadIsCalledWhatItIs) {
  struct Case {
    std::string from, to, message;
  };
  const std::vector<Case> cases = {
      {"}\nMOTION", "}\nROOT Prop\n{\n}\nMOTION", "a second ROOT, \"Prop\" beside \"Hips\""},
      {"Frame Time: 0.04", "", "where \"Frame Time:\" with the seconds of a frame"},
      {"Frame Time: 0.04", "Frame Time:", "where \"Frame Time:\" with the seconds of a frame"},
      {"Frame Time: 0.04", "Frame Time: 0,04", "\"0,04\", a number with a decimal comma"},
      {"OFFSET 0 5 0", "OFFSET 0 5,5 0", "line 8: found \"5,5\", a number with a decimal comma"},
      {"1 0 1 -1", "1,5 0 1 -1",
       "line 20, frame 1, joint Hips, Xposition: found \"1,5\", expected a "
       "finite number within +-1e+07; numbers are written with a point"},
      {"Frames: 2", "Frames: two", "the number of frames"},
      {"Frames: 2\n", "", "where Frames: is expected"}};
  for (const Case& c : cases) {
    const std::string message =
        refusal([&] { parse_bvh(replaced(text_of("Frames: 2", 2), c.from, c.to), "f"); });
    EXPECT_NE(message.find(c.message), std::string::npos) << message;
  }
}

TEST(BvhSlips, AGivenRateStandsInForAFrameTime) {
  BvhTextOptions options;
  options.fps = 50;
  for (const std::string time : {"Frame Time: 0.017", "Frame Time: 0", "Frame Time: nan", ""}) {
    const Bvh bvh = parse_bvh(text_of("Frames: 3", 3, time), "f", options);
    expect_frames(bvh, 3);
    EXPECT_EQ(bvh.fps, 50);
    EXPECT_EQ(kinds(bvh), time.empty() ? Kinds{"frame time missing"} : Kinds{}) << time;
  }
}

TEST(BvhSlips, ARoundedFrameTimeIsSaid) {
  const Bvh bvh = parse_bvh(text_of("Frames: 3", 3, "Frame Time: 0.017"), "f");
  EXPECT_EQ(bvh.fps, 60);
  ASSERT_EQ(kinds(bvh), Kinds{"frame time rounded"});
  EXPECT_EQ(bvh.remarks[0].text,
            "frame time 0.017 read as 60 frames a second (its digits are 58.82)");
}

// The files of ../shared/cases: what is right is in their README.
TEST(BvhSlips, SharedCases) {
  const auto cases = std::filesystem::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "cases";
  if (!std::filesystem::exists(cases)) GTEST_SKIP() << "no ../shared/cases";
  const auto strict = cases / "strict-parser", rates = cases / "short-frame-time";
  ReadReport report;
  EXPECT_EQ(read_clip(strict / "frames_one_less.bvh", {}, &report).frames(), 3);
  ASSERT_EQ(report.remarks.size(), 1u);
  EXPECT_EQ(report.remarks[0].kind, "frames announced");
  EXPECT_EQ(read_clip(strict / "named_end_site.bvh", {}, &report).frames(), 2);
  EXPECT_EQ(report.remarks.size(), 1u);
  EXPECT_NE(refusal([&] { read_clip(strict / "lfs_pointer.bvh"); }).find("is a Git LFS pointer"),
            std::string::npos);
  const std::string gap = refusal([&] { read_clip(strict / "nan.bvh"); });
  EXPECT_NE(gap.find("line 136, frame "), std::string::npos) << gap;
  EXPECT_NE(gap.find("--fill-gaps"), std::string::npos) << gap;
  ReadOptions filled;
  filled.fill_gaps = true;
  EXPECT_EQ(read_clip(strict / "nan.bvh", filled, &report).frames(), 3);
  EXPECT_EQ(report.remarks.back().kind, "gaps filled");
  EXPECT_EQ(read_clip(rates / "60fps_as_0.017.bvh", {}, &report).fps, 60);
  EXPECT_EQ(report.remarks.size(), 1u);
  EXPECT_EQ(read_clip(rates / "120fps_as_0.008.bvh", {}, &report).fps, 120);
  EXPECT_EQ(report.remarks.size(), 1u);
}

}  // namespace
}  // namespace mocaplm::bvh_slips_test
