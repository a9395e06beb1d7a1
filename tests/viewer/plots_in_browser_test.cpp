// Plots and charts on a page in a real browser (tests/support/browser.h), skipped without one.
#include "support/pages_in_browser.h"
#include "viewer/chart.h"
#include "viewer/page.h"
#include "viewer/plot.h"

namespace mocaplm::plots_in_browser_test {
namespace {

Plot long_plot() {
  Plot plot{
      "Mean squared error of the coefficients", "training steps", "bits a frame", false, false, {}};
  for (const char* name : {"training", "validation", "uniform, max", "quantile, mean", "tiles"}) {
    PlotSeries series{name, {}, true, true, ""};
    for (int i = 0; i < 12; ++i)
      series.points.push_back({25000.0 * i, 1e-4 * (i + 1.0), "point " + std::to_string(i)});
    plot.series.push_back(series);
  }
  return plot;
}

BarChart bars() {
  BarChart chart{"genre: clips of each class that are found", {"Majority class", "LDA", "Net"}, {}};
  for (const char* name : {"waack", "a-very-long-name-of-a-genre", "street-jazz"})
    chart.rows.push_back({name, {0, 50, 100}, "9 clips"});
  return chart;
}

MatrixChart matrix(std::size_t classes) {
  MatrixChart chart{"genre: what is taken for what", {}, {}};
  for (std::size_t i = 0; i < classes; ++i)
    chart.classes.push_back("raise-up-both-hands " + std::to_string(i));
  chart.counts.assign(classes, std::vector<long>(classes, 12));
  return chart;
}

class PlotsInBrowser : public PagesInBrowser {
 protected:
  static void SetUpTestSuite() {
    PagesInBrowser::SetUpTestSuite();
    if (!browser_) return;
    Page page;
    page.title = "Numbers";
    const Plot plot = long_plot();
    page.plots.push_back({plot_svg(plot), plot_table(plot)});
    for (const std::string& svg :
         {bars_svg(bars()), matrix_svg(matrix(10)), matrix_svg(matrix(60))})
      page.plots.push_back({svg, plot_table(plot)});
    write_page(*folder_ / "page.html", page);
  }
};

TEST_F(PlotsInBrowser, LettersHaveRoomAtEveryWidth) {
  for (const int width : {360, 390, 641, 800, 1280}) {
    browser_->window(width, 800, width < 600);
    browser_->open(url());
    EXPECT_EQ(crowded_texts(*browser_), Json::array()) << width;
    EXPECT_LE(browser_->evaluate("document.documentElement.scrollWidth").get<int>(), width);
    EXPECT_EQ(complaints(), std::vector<std::string>());
  }
}

TEST_F(PlotsInBrowser, TheMouseShowsTheNumbersOfTheNearestMark) {
  browser_->open(url());
  const Json at = browser_->evaluate(
      "(r => [r.left + r.width / 2 + 3, r.top + r.height / 2])"
      "(document.querySelectorAll('.picture circle[data-tip]')[2].getBoundingClientRect())");
  EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.tip').length"), 0);
  browser_->click(at[0].get<double>(), at[1].get<double>());
  EXPECT_EQ(browser_->evaluate("document.querySelector('.tip').textContent"),
            "point 2\ntraining steps: 50000\nbits a frame: 0.0003");
  EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.lit').length"), 1);
  browser_->click(1, 1);
  EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.tip, .lit').length"), 0);
  EXPECT_EQ(complaints(), std::vector<std::string>());
}

TEST_F(PlotsInBrowser, PicturesAndTablesHaveNames) {
  browser_->open(url());
  const Json tree = browser_->call("Accessibility.getFullAXTree");
  int pictures = 0, tables = 0;
  for (const Json& node : tree["nodes"]) {
    const std::string role = node.value(Json::json_pointer("/role/value"), "");
    const std::string name = node.value(Json::json_pointer("/name/value"), "");
    if (node.value("ignored", false)) continue;
    if (role == "image" || role == "img") {
      ++pictures;
      EXPECT_NE(name, "") << node.dump();
    }
    if (role == "table") {
      ++tables;
      EXPECT_NE(name, "") << node.dump();
    }
  }
  EXPECT_EQ(pictures, 4);
  EXPECT_EQ(tables, 4);
}

}  // namespace
}  // namespace mocaplm::plots_in_browser_test
