#include "viewer/report_page.h"

#include <gtest/gtest.h>

#include "support/refusal.h"

namespace mocaplm::report_page_test {
namespace {

TEST(ReportPage, HasTablesPicturesAndLinksToChapters) {
  ReportPage page;
  page.title = "a < b";
  page.note = "procedural";
  Table table("Table 1", {"class", "p"});
  table.row({"walk & run", 0.5});
  page.tables.push_back(table);
  page.chapters = {{"walk & run", {"<svg id=\"one\"></svg>", "<svg id=\"two\"></svg>"}}};
  const std::string html = render_report(page);
  for (const char* part :
       {"<title>a &lt; b</title>", "procedural", " scope=\"row\"", ">walk &amp; run</t",
        "<a href=\"#chapter-1\">walk &amp; run</a>", "id=\"chapter-1\"",
        "<div class=\"picture\"><svg id=\"two\">", "querySelectorAll"})
    EXPECT_TRUE(contains(html, part)) << part;
  EXPECT_LT(html.find("Table 1"), html.find("<svg id"));
  page.pictures_first = true;
  EXPECT_GT(render_report(page).find("Table 1"), render_report(page).find("<svg id"));
}

TEST(ReportPage, OfTablesAloneHasNoScript) {
  ReportPage page;
  page.title = "tables";
  page.tables.emplace_back("Table 1", std::vector<std::string>{"class"});
  const std::string html = render_report(page);
  EXPECT_FALSE(contains(html, "<script>"));
  EXPECT_FALSE(contains(html, "<nav"));
}

}  // namespace
}  // namespace mocaplm::report_page_test
