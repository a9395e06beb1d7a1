#include "viewer/page.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <regex>

#include "common/angles.h"
#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "motion/skeleton.h"
#include "support/refusal.h"
#include "viewer/assets.h"
#include "viewer/figure.h"
#include "viewer/html.h"
#include "viewer/pack.h"

namespace mocaplm::page_test {
namespace {

Clip random_clip(std::uint64_t seed, Eigen::Index frames, double fps) {
  Random random(seed);
  Clip clip;
  clip.name = "random";
  clip.fps = fps;
  clip.poses.resize(frames, 72);
  clip.trans.resize(frames, 3);
  for (double& x : clip.poses.reshaped()) x = random.uniform(-1.5, 1.5);
  for (double& x : clip.trans.reshaped()) x = random.uniform(-4, 4);
  return clip;
}

Page page_of(const Clip& clip) {
  Page page;
  page.title = "title";
  page.motions.push_back({"motion", clip, {}, {}, "caption"});
  return page;
}

// The page without three.js, which is Debian's file and checked by its own test.
std::string without_three(const std::string& html) {
  const std::size_t at = html.find(std::string(assets::three_js));
  EXPECT_NE(at, std::string::npos);
  return html.substr(0, at) + html.substr(at + assets::three_js.size());
}

Json data_of(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = html.find(open) + open.size();
  return Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

// Base64 by the definition: six bits a character, high bits first.
std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned> bits;
  for (const char c : text)
    for (int b = 5; c != '=' && b >= 0; --b)
      bits.push_back(static_cast<unsigned>(digits.find(c)) >> b & 1);
  std::string bytes;
  for (std::size_t i = 0; i + 7 < bits.size(); i += 8) {
    unsigned byte = 0;
    for (std::size_t b = i; b < i + 8; ++b) byte = 2 * byte + bits[b];
    bytes += static_cast<char>(byte);
  }
  return bytes;
}

// The way back from viewer/pack.h, with plain numbers: (frames, channels).
std::vector<std::int16_t> unpack(const std::string& text, std::size_t frames,
                                 std::size_t channels) {
  const std::string packed = unbase64(text);
  const std::size_t count = frames * channels;
  std::vector<unsigned char> bytes(2 * count + 1);
  uLongf size = bytes.size();
  EXPECT_EQ(
      uncompress(bytes.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
      Z_OK);
  EXPECT_EQ(size, 2 * count);
  std::vector<std::int16_t> values(count);
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t f = 0; f < frames; ++f) {
      const int folded = bytes[c * frames + f] + 256 * bytes[count + c * frames + f];
      int value = folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2;
      const auto before = [&](std::size_t back) { return values[(f - back) * channels + c]; };
      if (f > 1) value += 2 * before(1) - before(2);
      if (f == 1) value += before(1);
      values[f * channels + c] = static_cast<std::int16_t>(value);
    }
  return values;
}

class PageTest : public testing::Test {
  void SetUp() override {
    if (assets::three_js.empty()) GTEST_SKIP() << "built without three.js (libjs-three)";
  }
};

TEST_F(PageTest, RefersToNothingOutsideItself) {
  const std::string html = without_three(render_page(page_of(random_clip(1, 30, 30))));
  const std::regex outside(
      "https?:|//[a-z]+\\.|\\bsrc\\s*=|@import|url\\(|<link[^>]*href=\"(?!data:)",
      std::regex::icase);
  std::smatch found;
  EXPECT_FALSE(std::regex_search(html, found, outside)) << found.str();
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST_F(PageTest, EmbedsThreeJsWholeWithItsLicence) {
  const std::string html = render_page(page_of(random_clip(1, 2, 30)));
  EXPECT_NE(html.find("Copyright (c) 2010-2019 three.js authors"), std::string::npos);
  EXPECT_NE(html.find("THE SOFTWARE IS PROVIDED \"AS IS\""), std::string::npos);
  const std::string debian = "/usr/share/javascript/three/three.min.js";
  if (!std::filesystem::exists(debian)) GTEST_SKIP() << debian << " is not installed";
  EXPECT_EQ(assets::three_js, read_file(debian));
  EXPECT_EQ(assets::three_js.find("</script"), std::string::npos);
  EXPECT_EQ(assets::three_js.find("<!--"), std::string::npos);
}

TEST_F(PageTest, HostileTextStaysText) {
  const std::string evil =
      "</script><script>alert(1)</script><!-- {{data}} \" onload='x' & \xff\x01";
  Page page = page_of(random_clip(1, 3, 30));
  page.title = page.note = page.highlight_name = evil;
  page.motions[0].title = page.motions[0].caption = page.motions[0].clip.name = evil;
  page.motions[0].clip.labels[evil] = evil;
  page.motions[0].highlighted_joints = {17};
  page.settings = {{evil, evil}};
  Table table(evil, {evil, evil});
  table.row({evil, 1.5});
  table.note(evil);
  page.tables.push_back(table);
  const std::string html = without_three(render_page(page));
  EXPECT_EQ(html.find("alert(1)</script"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
  // A quote may stand in the JSON, where it is text; nowhere in the elements before it.
  EXPECT_GT(html.find(" onload='"), html.find("id=\"data\""));
  // Three script elements of our own, and no more ends than those.
  std::size_t ends = 0;
  for (std::size_t at = html.find("</script"); at != std::string::npos;
       at = html.find("</script", at + 1))
    ++ends;
  EXPECT_EQ(ends, 3u);
  const std::string title = data_of(html)["motions"][0]["title"];
  EXPECT_EQ(title.substr(0, 9), "</script>");
}

TEST_F(PageTest, PositionsDecodeToForwardKinematics) {
  const double rates[] = {20, 30, 60, 60.00002, 100, 119.88, 120};
  const int expected_every[] = {1, 1, 1, 1, 2, 2, 2};
  for (std::size_t k = 0; k < std::size(rates); ++k) {
    const Clip clip = random_clip(k, 41, rates[k]);
    const Json motion = data_of(render_page(page_of(clip)))["motions"][0];
    const auto every = motion["every"].get<Eigen::Index>();
    EXPECT_EQ(every, expected_every[k]) << rates[k];
    EXPECT_NEAR(motion["fps"].get<double>() * static_cast<double>(every), clip.fps, 1e-9);
    ASSERT_EQ(motion["frames"].get<Eigen::Index>(), (clip.frames() + every - 1) / every);
    const std::vector<std::int16_t> values =
        unpack(motion["points"], motion["frames"].get<std::size_t>(), kFigurePoints * 3);
    ASSERT_EQ(values.size(), motion["frames"].get<std::size_t>() * kFigurePoints * 3);
    const double unit = motion["unit"];
    // The page moves the whole motion; the first pelvis tells by how much.
    const auto point = [&](Eigen::Index f, int p) {
      const auto at = static_cast<std::size_t>((f * kFigurePoints + p) * 3);
      return Eigen::RowVector3d(values[at] * unit, values[at + 1] * unit, values[at + 2] * unit);
    };
    const Eigen::RowVector3d shift =
        point(0, 0) - Eigen::RowVector3d(joint_positions(clip, 0).row(0));
    for (Eigen::Index f = 0; f < motion["frames"].get<Eigen::Index>(); ++f) {
      const JointPositions truth = joint_positions(clip, f * every);
      for (int j = 0; j < kJoints; ++j)
        EXPECT_LT((point(f, j) - truth.row(j) - shift).norm(), 1e-3)
            << "frame " << f << " joint " << j;
    }
  }
}

// A person's joints do not jump: a minute of smooth motion at 60 fps is a quarter of its numbers.
TEST_F(PageTest, SmoothMotionIsSmall) {
  Clip clip = random_clip(1, 3601, 60);
  for (Eigen::Index f = 0; f < clip.frames(); ++f) {
    for (int c = 0; c < 72; ++c)
      clip.poses(f, c) = 0.6 * std::sin(0.002 * static_cast<double>(f) * (5 + c % 7) + c);
    for (int c = 0; c < 3; ++c)
      clip.trans(f, c) = std::sin(0.01 * static_cast<double>(f) + 1.5 * c);
  }
  const std::size_t small = render_page(page_of(random_clip(1, 1, 60))).size();
  const std::size_t large = render_page(page_of(clip)).size();
  EXPECT_LT(small, assets::three_js.size() + 80'000);
  EXPECT_LT(large - small, 3600u * kFigurePoints * 3 * 2 / 3);
}

TEST(Pack, WrapsAndComesBack) {
  Random random(7);
  for (const std::size_t frames : {0, 1, 2, 3, 50}) {
    std::vector<std::int16_t> values(frames * 5);
    for (std::int16_t& value : values)
      value = static_cast<std::int16_t>(random.uniform(-32768, 32767.99));
    EXPECT_EQ(unpack(pack_points(values, 5), frames, 5), values);
  }
  const std::vector<std::int16_t> ends = {32767, -32768, 32767, -32768, -32768};
  EXPECT_EQ(unpack(pack_points(ends, 1), 5, 1), ends);
}

TEST(PageOfPlots, NeedsNeitherFiguresNorThreeJs) {
  Page page;
  page.title = "numbers";
  Table table("t", {"x", "y"});
  table.row({"a", 1});
  page.plots.push_back({"<svg><title>one</title></svg>", table});
  const std::string html = render_page(page);
  EXPECT_NE(html.find("<svg><title>one</title></svg>"), std::string::npos);
  EXPECT_NE(html.find("<th scope=\"row\" class=\"text\">a</th>"), std::string::npos);
  EXPECT_EQ(html.find("<canvas"), std::string::npos);
  EXPECT_LT(html.size(), 40'000u);
}

TEST(PageOfPlots, SettingsAreReadable) {
  Page page;
  add_settings(page,
               {{"model", {{"n_layer", 4}, {"dropout", 20.0}, {"joints", {"thesis", "head"}}}},
                {"from", nullptr},
                {"conditions", Json::array()},
                {"mirror", false},
                {"data", "a/b"}});
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"n_layer", "4"},   {"dropout", "20"},        {"joints", "thesis, head"},
      {"from", "\u2013"}, {"conditions", "\u2013"}, {"mirror", "false"},
      {"data", "a/b"}};
  EXPECT_EQ(page.settings, expected);
  page.tables.push_back(Table("t", {"x"}));
  EXPECT_PRED2(contains, render_page(page), "<dt>n_<wbr>layer</dt><dd>4</dd>");
}

TEST(Html, ColumnsOfTextAreLeftAligned) {
  Table table("t", {"clip", "share", "taken for", "count"});
  table.row({"a", "12.5 %", "waack", 3});
  table.row({"b", "-", std::string(60, 'x'), nullptr});
  const std::string html = html_table(table);
  EXPECT_PRED2(contains, html, "<td>12.5 %</td><td class=\"text\">waack</td><td>3</td>");
  EXPECT_PRED2(contains, html, "<th scope=\"col\" class=\"text\">taken for</th>");
  EXPECT_PRED2(contains, html, "<th scope=\"col\">count</th>");
  EXPECT_PRED2(contains, html, "class=\"text long\">xxx");
}

TEST_F(PageTest, RefusesWhatItCannotShow) {
  Page page;
  EXPECT_THROW(render_page(page), UsageError);
  page = page_of(random_clip(1, 3, 30));
  page.motions[0].highlighted_joints = {24};
  EXPECT_THROW(render_page(page), UsageError);
  page = page_of(random_clip(1, 3, 30));
  page.motions[0].clip.poses(1, 5) = std::nan("");
  EXPECT_THROW(render_page(page), DataError);
}

TEST(Figure, StandsOnTheGroundAndIsCentred) {
  Clip clip = random_clip(3, 20, 30);
  clip.poses.setZero();  // the T-pose, moved about: its soles are its lowest points
  const Figure figure = make_figure(clip);
  const Eigen::RowVectorXd low = clip.trans.colwise().minCoeff(),
                           high = clip.trans.colwise().maxCoeff();
  EXPECT_NEAR(figure.shift.x(), -(low.x() + high.x()) / 2 - rest_joints()(0, 0), 1e-9);
  EXPECT_NEAR(figure.shift.z(), -(low.z() + high.z()) / 2 - rest_joints()(0, 2), 1e-9);
  double ball = 1e9;
  for (Eigen::Index f = 0; f < figure.frames; ++f)
    ball =
        std::min(ball, figure.points[static_cast<std::size_t>((f * kFigurePoints + 10) * 3 + 1)] *
                           figure.unit);
  EXPECT_NEAR(ball, 0.034, 0.004);  // the ball of the foot is its own radius above the ground
}

TEST(Figure, AFewFaultyFramesDoNotLiftTheRest) {
  Clip clip = random_clip(3, 100, 30);
  clip.poses.setZero();
  clip.trans.col(1).setZero();
  const double ground = make_figure(clip).shift.y();
  clip.trans(7, 1) = -0.02;  // a small step down is the ground
  EXPECT_NEAR(make_figure(clip).shift.y(), ground + 0.02, 1e-9);
  clip.trans.col(1).head(4).setConstant(-0.5);
  EXPECT_NEAR(make_figure(clip).shift.y(), ground, 1e-9);
}

TEST(Figure, SurfacePointsTurnWithTheirJoints) {
  Clip clip = random_clip(4, 1, 30);
  clip.poses.setZero();
  const JointPositions rest = figure_points(clip, 0);
  clip.poses(0, 1) = kPi / 2;  // the whole body turns to its left: +Z becomes +X
  const JointPositions turned = figure_points(clip, 0);
  const Eigen::RowVector3d face = rest.row(25) - rest.row(15),
                           now = turned.row(25) - turned.row(15);
  EXPECT_NEAR(now.x(), face.z(), 1e-9);
  EXPECT_NEAR(now.y(), face.y(), 1e-9);
}

TEST(Figure, FarPathsKeepTheirShapeWithACoarserUnit) {
  Clip clip = random_clip(5, 2, 30);
  clip.trans.row(0) << -500, 0, 0;
  clip.trans.row(1) << 500, 0, 0;
  const Figure figure = make_figure(clip);
  EXPECT_GT(figure.unit, 0.01);
  EXPECT_NEAR(figure.points[0] * figure.unit, -500, 0.02);
}

TEST(Html, Base64AndTemplate) {
  EXPECT_EQ(base64({}), "");
  EXPECT_EQ(base64({1, 1}), "AQE=");
  EXPECT_EQ(base64({'A', 'B', 'C', 'D'}), "QUJDRA==");
  EXPECT_EQ(base64({255, 255, 255}), "////");
  EXPECT_EQ(fill_template("a{{x}}b{{y}}", {{"x", "{{y}}"}, {"y", "1"}}), "a{{y}}b1");
  EXPECT_THROW(fill_template("{{z}}", {}), Error);
}

}  // namespace
}  // namespace mocaplm::page_test
