// The page of every command that writes one, in a real browser: nothing is asked of any network,
// nothing complains, figures move. Skipped without Chromium (tests/support/browser.h).
#include "support/pages_in_browser.h"
#include "app/trained_run.h"

namespace mocaplm::pages_in_browser_test {
namespace {

class CommandPages : public TrainedRun {
 protected:
  static void SetUpTestSuite() {
    TrainedRun::SetUpTestSuite();
    if (!find_browser().empty()) browser_ = std::make_unique<Browser>(find_browser());
  }
  static void TearDownTestSuite() {
    browser_.reset();
    TrainedRun::TearDownTestSuite();
  }
  void SetUp() override {
    if (!browser_) GTEST_SKIP() << kNoBrowser;
  }

  // Opens a page that a command has written, on a desktop and on a phone; returns how many figures
  // it has.
  static int figures(const std::string& name) {
    const std::string url = "file://" + path(name).string() + "#t=0.2";
    for (const int width : {900, 390}) {
      browser_->window(width, 500, width < 600);
      browser_->open(url);
      EXPECT_EQ(complaints(*browser_), std::vector<std::string>()) << name;
      EXPECT_EQ(crowded_texts(*browser_), Json::array()) << name;
      EXPECT_LE(browser_->evaluate("document.documentElement.scrollWidth").get<int>(), width)
          << name;
    }
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.picture').length"),
              browser_->evaluate("document.querySelectorAll('.plot table').length"))
        << "no picture without its numbers";
    if (browser_->evaluate("typeof mocaplm") == "undefined") return 0;
    check_playing(name);
    return browser_->evaluate("document.querySelectorAll('#captions li').length");
  }

  static void check_playing(const std::string& name) {
    const auto seconds = [] { return browser_->evaluate("mocaplm.player.seconds").get<double>(); };
    EXPECT_EQ(browser_->evaluate("mocaplm.positions(0).flat().every(Number.isFinite)"), true);
    const double before = seconds();
    browser_->key(" ", " ");
    for (int i = 0; i < 50 && seconds() == before; ++i) Browser::pause(0.1);
    EXPECT_NE(seconds(), before) << name;
    EXPECT_EQ(complaints(*browser_), std::vector<std::string>()) << name;
  }

  static std::string clip() { return at("data/clips/gWA_sBM_cAll_d25_mWA1_ch01.npz"); }

  inline static std::unique_ptr<Browser> browser_;
};

TEST_F(CommandPages, OfMotionsPlay) {
  must("view " + at("data") + " --out " + at("view.html"));
  EXPECT_GE(figures("view.html"), 2);
  must("generate --model " + at("tuned") + " --prompt " + clip() +
       " --joints right_arm --seconds 1 --out " + at("dance"));
  EXPECT_EQ(figures("dance.html"), 2);
  must("query --index " + at("data") + " gWA_sBM_cAll_d25_mWA1_ch01 --window 32 --page " +
       at("query.html"));
  EXPECT_GE(figures("query.html"), 2);
  must("interpolate " + clip() + " " + clip() + " --steps 1 --out " + at("between.html"));
  EXPECT_EQ(figures("between.html"), 3);
}

TEST_F(CommandPages, OfTrainingAndItsTestsPlay) {
  EXPECT_EQ(figures("run/training.html"), 3) << "a clip, samples of the first and last validation";
  must("classify --threads 1 --steps 2 --labels genre --model " + at("run") + " --data " +
       at("data") + " --page " + at("classes.html"));
  figures("classes.html");
}

TEST_F(CommandPages, OfTokenizersShowWhatIsLost) {
  must("tokenize " + clip() + " --bins 30 --out " + at("t.json") + " --page " + at("tokens.html"));
  EXPECT_EQ(figures("tokens.html"), 2);
  must("tokenize " + at("data") + " --report bins:30 bins:60 --page " + at("report.html"));
  EXPECT_EQ(figures("report.html"), 0);
}

}  // namespace
}  // namespace mocaplm::pages_in_browser_test
