// A page of tables and pictures: what a test found. Tables come first, then the pictures, side by
// side, in chapters that the page's head links to. Its style is that of all pages (viewer/page.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"

namespace mocaplm {

struct ReportChapter {
  std::string title;                  // "": no heading
  std::vector<std::string> pictures;  // SVG (viewer/plot.h), put into the page as it is
};

struct ReportPage {
  std::string title;
  std::string note;  // shown beside the title, e.g. "procedural dances"
  std::vector<Table> tables;
  std::vector<ReportChapter> chapters;
  bool pictures_first = false;
};

// All text is escaped.
std::string render_report(const ReportPage& page);
void write_report_page(const std::filesystem::path& path, const ReportPage& page);

}  // namespace mocaplm
