#include "common/csv.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// Walks over the text one record at a time.
class Records {
 public:
  Records(const std::string& text, const std::string& name) : text_(text), name_(name) {
    if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) at_ = 3;
  }

  // False at the end of the text. `line` is where the record starts.
  bool next(std::vector<std::string>& cells, std::size_t& line) {
    while (at_ < text_.size() && (text_[at_] == '\n' || text_[at_] == '\r')) skip();
    if (at_ >= text_.size()) return false;
    line = line_;
    cells.assign(1, cell());
    while (at_ < text_.size() && text_[at_] == ',') {
      skip();
      cells.push_back(cell());
    }
    return true;
  }

 private:
  void skip() {
    if (text_[at_] == '\n') ++line_;
    ++at_;
  }

  std::string cell() {
    std::string value;
    if (at_ < text_.size() && text_[at_] == '"') {
      quoted(value);
    } else {
      while (at_ < text_.size() && std::string(",\r\n").find(text_[at_]) == std::string::npos)
        value += text_[at_++];
    }
    return value;
  }

  void quoted(std::string& value) {
    const std::size_t start = line_;
    for (skip(); at_ < text_.size(); skip()) {
      const bool doubled = text_.compare(at_, 2, "\"\"") == 0;
      if (text_[at_] == '"' && !doubled) break;
      value += text_[at_];
      if (doubled) skip();
    }
    if (at_ >= text_.size()) throw DataError(at_line(name_, start), "a quote is never closed");
    skip();
    if (at_ < text_.size() && std::string(",\r\n").find(text_[at_]) == std::string::npos)
      throw DataError(at_line(name_, line_),
                      std::string("found '") + text_[at_] +
                          "' after a closing quote, expected ',' or a new line");
  }

  const std::string& text_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 1;
};

}  // namespace

int Csv::find(const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

std::size_t Csv::column(const std::string& name) const {
  const int found = find(name);
  if (found < 0)
    throw DataError(at_line(file, 1), "has no column \"" + name + "\"" +
                                          did_you_mean(name, columns) +
                                          " (columns: " + join(columns, ", ") + ")");
  return static_cast<std::size_t>(found);
}

Csv parse_csv(const std::string& text, const std::string& name) {
  Csv csv;
  csv.file = name;
  Records records(text, name);
  std::size_t line = 1;
  if (!records.next(csv.columns, line))
    throw DataError(in_file(name), "is empty, expected a header line");
  for (const std::string& column : csv.columns) {
    if (column.empty()) throw DataError(at_line(name, line), "a column has no name");
    if (std::count(csv.columns.begin(), csv.columns.end(), column) > 1)
      throw DataError(at_line(name, line), "the column \"" + column + "\" is there twice");
  }
  std::vector<std::string> cells;
  while (records.next(cells, line)) {
    if (cells.size() != csv.columns.size())
      throw DataError(at_line(name, line), "has " + std::to_string(cells.size()) +
                                               " cells, but the header has " +
                                               std::to_string(csv.columns.size()));
    csv.rows.push_back(cells);
    csv.lines.push_back(line);
  }
  return csv;
}

Csv read_csv(const std::filesystem::path& path) {
  return parse_csv(read_file(path, std::uintmax_t{64} << 20), path.string());
}

}  // namespace mocaplm
