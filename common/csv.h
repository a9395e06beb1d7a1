// Comma-separated tables with a header line (RFC 4180: quotes, doubled quotes, line breaks in
// quotes).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mocaplm {

struct Csv {
  std::string file;
  std::vector<std::string> columns;            // each name once
  std::vector<std::vector<std::string>> rows;  // each as long as `columns`
  std::vector<std::size_t> lines;              // where each row starts, from 1

  // Index of a column, or -1.
  int find(const std::string& column) const;
  // The same; DataError with the nearest column when there is none.
  std::size_t column(const std::string& column) const;
};

// Throws DataError naming the line: no header, a column twice, a row with another number of cells,
// an open quote. A byte order mark and CRLF are taken as they come; empty lines are skipped.
Csv read_csv(const std::filesystem::path& path);
Csv parse_csv(const std::string& text, const std::string& name);

}  // namespace mocaplm
