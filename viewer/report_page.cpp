#include "viewer/report_page.h"

#include "common/files.h"
#include "viewer/assets.h"
#include "viewer/html.h"

namespace mocaplm {

namespace {

// Tables are wider than a phone: they scroll below a caption and beside a first column that stay.
constexpr const char* kStyle = R"(
h2.chapter { margin: 26px 0 10px; font-size: 1.15rem; }
nav { display: flex; flex-wrap: wrap; gap: 2px 18px; margin: 0 0 18px; }
nav a { color: var(--accent); }
.pictures { display: grid; gap: 16px; margin: 0 0 24px;
  grid-template-columns: repeat(auto-fill, minmax(min(520px, 100%), 1fr)); }
.picture { min-width: 0; }
th, td { white-space: nowrap; }
caption { position: sticky; left: 0; max-width: calc(100vw - 36px); white-space: normal; }
.table p { position: sticky; left: 0; max-width: calc(100vw - 36px); }
tbody th, thead th:first-child { position: sticky; left: 0; background: var(--paper); }
)";

std::string anchor(std::size_t index) {
  return "chapter-" + std::to_string(index + 1);
}

std::string links_html(const std::vector<ReportChapter>& chapters) {
  std::string out;
  for (std::size_t i = 0; i < chapters.size(); ++i)
    if (!chapters[i].title.empty())
      out += "<a href=\"#" + anchor(i) + "\">" + escape_html(chapters[i].title) + "</a>\n";
  return out.empty() ? "" : "<nav aria-label=\"Chapters\">\n" + out + "</nav>\n";
}

std::string chapters_html(const std::vector<ReportChapter>& chapters) {
  std::string out;
  for (std::size_t i = 0; i < chapters.size(); ++i) {
    out += "<section id=\"" + anchor(i) + "\">\n";
    if (!chapters[i].title.empty())
      out += "<h2 class=\"chapter\">" + escape_html(chapters[i].title) + "</h2>\n";
    out += "<div class=\"pictures\">\n";
    for (const std::string& picture : chapters[i].pictures)
      out += "<div class=\"picture\">" + picture + "</div>\n";
    out += "</div>\n</section>\n";
  }
  return out;
}

std::string tables_html(const std::vector<Table>& tables) {
  std::string out;
  for (const Table& table : tables) out += html_table(table);
  return out;
}

}  // namespace

std::string render_report(const ReportPage& page) {
  const std::string tables = tables_html(page.tables), chapters = chapters_html(page.chapters);
  return fill_template(
      assets::page_html,
      {{"title", escape_html(page.title)},
       {"note", page.note.empty() ? "" : "<p class=\"note\">" + escape_html(page.note) + "</p>"},
       {"style", std::string(assets::page_css) + kStyle},
       {"stage", links_html(page.chapters)},
       {"captions", page.pictures_first ? chapters : tables},
       {"few_settings", ""},
       {"plots", page.pictures_first ? tables : chapters},
       {"tables", ""},
       {"many_settings", ""},
       {"credit", ""},
       {"scripts",
        page.chapters.empty() ? "" : "<script>\n" + std::string(assets::plot_js) + "</script>\n"}});
}

void write_report_page(const std::filesystem::path& path, const ReportPage& page) {
  write_file(path, render_report(page));
}

}  // namespace mocaplm
