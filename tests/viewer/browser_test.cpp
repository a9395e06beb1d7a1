// The page in a real browser: headless Chromium (tests/support/browser.h), skipped without one.
#include <cmath>
#include <set>

#include "support/pages_in_browser.h"

#include "motion/skeleton.h"
#include "viewer/assets.h"
#include "viewer/figure.h"
#include "viewer/page.h"

namespace mocaplm::browser_test {
namespace {

// A body that turns, bends and walks about, without a repeated frame.
Clip moving_clip(const std::string& name, Eigen::Index frames, double fps) {
  Clip clip;
  clip.name = name;
  clip.fps = fps;
  clip.poses.resize(frames, 72);
  clip.trans.resize(frames, 3);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f) / fps;
    for (int c = 0; c < 72; ++c)
      clip.poses(f, c) = 0.35 * std::sin((1 + 0.13 * (c % 5)) * t + 0.7 * c);
    clip.trans.row(f) << std::sin(t), 0.95 + 0.05 * std::sin(3 * t), 0.3 * t;
  }
  return clip;
}

class BrowserTest : public PagesInBrowser {
 protected:
  static void SetUpTestSuite() {
    if (!assets::three_js.empty()) PagesInBrowser::SetUpTestSuite();
    if (!browser_) return;
    Page page;
    page.title = "Two dances";
    page.highlight_name = "prompted joints";
    page.motions.push_back({"prompt", first(), {17, 19, 21}, {}, "The prompt"});
    page.motions.push_back({"generated", second(), {17, 19, 21}, {}, "Generated"});
    page.settings = {{"model", "small"}, {"seed", "7"}};
    write_page(*folder_ / "page.html", page);
    page.motions.clear();
    for (int i = 0; i < 10; ++i)
      page.motions.push_back({"dance number " + std::to_string(i), first(), {}, {}, ""});
    write_page(*folder_ / "many.html", page);
  }
  void SetUp() override {
    if (assets::three_js.empty()) GTEST_SKIP() << "built without three.js (libjs-three)";
    PagesInBrowser::SetUp();
  }

  static Clip first() { return moving_clip("prompt", 241, 60); }
  static Clip second() { return moving_clip("generated", 361, 120); }  // thinned to 60 fps

  // The joints as shown against the program's own forward kinematics, in millimetres.
  static double distance(int index, const Clip& clip, Eigen::Index frame) {
    const Json shown = browser_->evaluate("mocaplm.positions(" + std::to_string(index) + ")");
    const JointPositions truth = joint_positions(clip, frame);
    const Eigen::RowVector3d shift = make_figure(clip).shift;
    double most = 0;
    for (int j = 0; j < kJoints; ++j) {
      const Json& p = shown[static_cast<std::size_t>(j)];
      const Eigen::RowVector3d at(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
      most = std::max(most, (at - truth.row(j) - shift).norm());
    }
    return 1000 * most;
  }

  static double seconds() { return browser_->evaluate("mocaplm.player.seconds"); }
  static bool playing() { return browser_->evaluate("mocaplm.player.playing"); }
};

TEST_F(BrowserTest, PlaysWithoutErrorOrRequest) {
  browser_->open(url());
  EXPECT_TRUE(playing());
  EXPECT_TRUE(browser_->evaluate("mocaplm.view instanceof Stage"));
  const double before = seconds();
  for (int i = 0; i < 100 && seconds() <= before; ++i) Browser::pause(0.1);
  EXPECT_GT(seconds(), before);
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

TEST_F(BrowserTest, AScrubShowsTheFrameOfTheForwardKinematics) {
  browser_->open(url("#t=0"));
  EXPECT_FALSE(playing());
  const Json box = browser_->evaluate(
      "(r => [r.left, r.top, r.width, r.height])(document.getElementById('scrub')"
      ".getBoundingClientRect())");
  std::set<int> frames;
  for (const double share : {0.1, 0.37, 0.62, 0.95}) {
    browser_->click(box[0].get<double>() + share * box[2].get<double>(),
                    box[1].get<double>() + box[3].get<double>() / 2);
    const int frame = browser_->evaluate("mocaplm.player.frame");
    EXPECT_NEAR(frame, 240 * share, 10);
    frames.insert(frame);
    EXPECT_LT(distance(0, first(), frame), 1) << frame;
    EXPECT_LT(distance(1, second(), 2 * std::min(frame, 180)), 1) << frame;
  }
  EXPECT_EQ(frames.size(), 4u);
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

TEST_F(BrowserTest, KeysMoveTheClock) {
  browser_->open(url("#t=1"));
  browser_->key("ArrowRight");
  EXPECT_NEAR(seconds(), 1 + 1 / 60.0, 1e-9);
  browser_->key("ArrowLeft", "", 8);  // with shift
  EXPECT_NEAR(seconds(), 1 / 60.0, 1e-9);
  browser_->key("End");
  EXPECT_NEAR(seconds(), 4, 1e-9);
  browser_->key("Home");
  EXPECT_EQ(seconds(), 0);
  browser_->key(" ", " ");
  EXPECT_TRUE(playing());
  browser_->key(" ", " ");
  EXPECT_FALSE(playing());
  browser_->key("<", "<");
  EXPECT_EQ(browser_->evaluate("mocaplm.player.speed"), 0.5);
  browser_->key("l", "l");
  EXPECT_EQ(browser_->evaluate("mocaplm.player.loop"), false);
  browser_->key("?", "?");
  EXPECT_EQ(browser_->evaluate("document.getElementById('help').open"), true);
  browser_->key("Escape");
  EXPECT_EQ(browser_->evaluate("document.getElementById('help').open"), false);
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

TEST_F(BrowserTest, FiguresAreLaidOverEachOther) {
  browser_->open(url("#t=0"));
  const std::string apart =
      "(([a, b]) => Math.hypot(a.now[0] + a.at.x - b.now[0] - b.at.x, a.now[2] + a.at.z - b.now[2]"
      " - b.at.z))(mocaplm.view.actors)";
  EXPECT_GT(browser_->evaluate(apart).get<double>(), 0.5);
  browser_->key("o", "o");
  EXPECT_LT(browser_->evaluate(apart).get<double>(), 1e-5);
  EXPECT_EQ(browser_->evaluate("document.getElementById('layout').value"), "over");
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

TEST_F(BrowserTest, TrailsAreDrawnAsLongAsAskedFor) {
  browser_->open(url("#t=2"));
  EXPECT_EQ(browser_->evaluate("mocaplm.view.trails.length"), 0);
  browser_->key("t", "t");
  EXPECT_EQ(browser_->evaluate("mocaplm.view.trails.length"), 4) << "two wrists of two";
  const std::string pieces = "mocaplm.view.trails[0].mesh.geometry.drawRange.count / 6";
  EXPECT_EQ(browser_->evaluate(pieces), 72) << "1.2 s at 60 fps";
  browser_->evaluate(
      "(e => { e.value = 'whole'; e.onchange(); })(document.getElementById('length'))");
  EXPECT_EQ(browser_->evaluate(pieces), 240);
  browser_->evaluate("joints.querySelector('input[value=\"15\"]').click()");
  EXPECT_EQ(browser_->evaluate("mocaplm.view.trails.length"), 6) << "the heads, too";
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

// Names as assistive technology gets them, of all that can be worked.
TEST_F(BrowserTest, EveryControlHasAName) {
  browser_->open(url("#t=0"));
  browser_->evaluate("trailpanel.open = true");
  for (const bool help : {false, true}) {
    if (help) browser_->key("?", "?");
    int controls = 0;
    const Json tree = browser_->call("Accessibility.getFullAXTree");
    for (const Json& node : tree["nodes"]) {
      if (node.value("ignored", false)) continue;
      const std::string role = node.value(Json::json_pointer("/role/value"), "");
      static const std::set<std::string> kControls = {
          "button", "checkbox", "combobox", "slider",        "image",
          "img",    "dialog",   "region",   "MenuListPopup", "DisclosureTriangle"};
      if (!kControls.count(role) || role == "MenuListPopup") continue;
      ++controls;
      EXPECT_NE(node.value(Json::json_pointer("/name/value"), ""), "") << node.dump();
    }
    EXPECT_GE(controls, help ? 2 : 25);
  }
}

TEST_F(BrowserTest, DoesNotStartByItselfWhereMotionIsUnwanted) {
  browser_->media("prefers-reduced-motion", "reduce");
  browser_->open(url());
  EXPECT_FALSE(playing());
  browser_->key(" ", " ");
  EXPECT_TRUE(playing()) << "it may still be asked to";
}

TEST_F(BrowserTest, FitsAPhoneLightAndDark) {
  for (const char* scheme : {"light", "dark"}) {
    browser_->window(360, 740, true);
    browser_->media("prefers-color-scheme", scheme);
    browser_->open(url("#t=1"));
    EXPECT_LE(browser_->evaluate("document.documentElement.scrollWidth").get<int>(), 360);
    // Nothing is cut off, and fingers find it.
    EXPECT_EQ(
        browser_->evaluate(
            "[...document.querySelectorAll('button, select, #scrub')].filter(e => {"
            "const r = e.getBoundingClientRect(); return e.checkVisibility() && !(r.left >= 0 &&"
            "r.right <= 360 && r.height >= 30)}).map(e => e.id)"),
        Json::array());
    EXPECT_EQ(complaints(), std::vector<std::string>());
  }
}

// Where the shown names meet; and all figures in their rows.
TEST_F(BrowserTest, NamesOfManyFiguresDoNotMeet) {
  for (const auto& [width, height] : {std::pair(900, 560), std::pair(390, 844)}) {
    browser_->window(width, height, width < 600);
    browser_->open(url("#flat&t=1", "many.html"));  // drawn in no time
    EXPECT_EQ(browser_->evaluate("new Set(mocaplm.view.actors.map((a) => a.row)).size"),
              width < 600 ? 4 : 2);
    for (const double t : {0.0, 0.7, 2.4}) {
      browser_->evaluate("mocaplm.seek(" + std::to_string(t) + ")");
      EXPECT_EQ(browser_->evaluate(
                    "(boxes => boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => a.left < "
                    "b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)).length)"
                    "([...document.getElementById('names').children].map((name) => "
                    "name.getBoundingClientRect()))"),
                0)
          << width << " at " << t;
    }
  }
}

TEST_F(BrowserTest, DrawsFlatWithoutWebGl) {
  browser_->open(url("#flat&t=1"));
  EXPECT_TRUE(browser_->evaluate("mocaplm.view instanceof FlatView"));
  const std::string painted =
      "(c => c.getContext('2d').getImageData(0, 0, c.width, c.height).data"
      ".filter((x, i) => i % 4 == 3 && x > 200).length)(canvas)";
  EXPECT_GT(browser_->evaluate(painted).get<int>(), 2000);
  browser_->key("t", "t");
  browser_->key("o", "o");
  browser_->key("ArrowRight");
  EXPECT_LT(distance(0, first(), 61), 1);
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

}  // namespace
}  // namespace mocaplm::browser_test
