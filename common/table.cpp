#include "common/table.h"

#include <algorithm>
#include <cassert>

#include "common/text.h"

namespace mocaplm {

namespace {

// Counts characters, not bytes, of UTF-8 text.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

std::string pad(const std::string& text, std::size_t to, bool left) {
  const std::string space(to > width(text) ? to - width(text) : 0, ' ');
  return left ? text + space : space + text;
}

// A line of a table at most, where its last column can be folded, and how far that is folded.
constexpr std::size_t kWidest = 100, kNarrowest = 40;

// Breaks the last column's texts at spaces so that they fit a screen from column `before` on.
// Returns whether any was broken: a long word or a number stays as it is.
bool fold(std::vector<std::vector<std::string>>& cells, std::size_t before) {
  const std::size_t most = std::max(kNarrowest, before < kWidest ? kWidest - before : 0);
  bool broken = false;
  for (std::vector<std::string>& lines : cells) {
    const std::vector<std::string> words = split(lines[0], ' ');
    lines = {words[0]};
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (width(lines.back()) + 1 + width(words[i]) > most)
        lines.push_back(words[i]);
      else
        lines.back() += " " + words[i];
    }
    broken = broken || lines.size() > 1;
  }
  return broken;
}

std::size_t widest_of(const std::vector<std::vector<std::string>>& cells, std::size_t widest) {
  for (const std::vector<std::string>& lines : cells)
    for (const std::string& line : lines) widest = std::max(widest, width(line));
  return widest;
}

}  // namespace

Table::Table(std::string title, std::vector<std::string> columns)
    : title_(std::move(title)), columns_(std::move(columns)) {}

void Table::row(std::vector<Json> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::cell(std::size_t column, const Json& value) const {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.dump();
  const int digits = column < digits_.size() ? digits_[column] : -1;
  return digits < 0 ? format_number(value.get<double>())
                    : format_fixed(value.get<double>(), digits);
}

std::string Table::text() const {
  std::vector<std::size_t> widths;
  std::size_t before = 0;  // where the last column begins
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (c > 0) before += widths.back() + 2;
    std::size_t widest = width(columns_[c]);
    for (const auto& cells : rows_) widest = std::max(widest, width(cell(c, cells[c])));
    widths.push_back(widest);
  }
  const std::size_t last = columns_.size() - 1;
  std::vector<std::vector<std::string>> ends;  // the last column's cells, in lines
  for (const auto& cells : rows_) ends.push_back({cell(last, cells[last])});
  const bool folds = last > 0 && before + widths[last] > kWidest && fold(ends, before);
  if (folds) widths[last] = widest_of(ends, width(columns_[last]));
  std::string out = title_.empty() ? "" : title_ + "\n", rule;
  for (std::size_t c = 0; c <= last; ++c) {
    out += (c ? "  " : "") + pad(columns_[c], widths[c], c == 0 || (folds && c == last));
    rule += (c ? "  " : "") + std::string(widths[c], '-');
  }
  out += "\n" + rule + "\n";
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (std::size_t c = 0; c < last; ++c)
      out += pad(cell(c, rows_[r][c]), widths[c], c == 0) + "  ";
    for (std::size_t i = 0; i < ends[r].size(); ++i)
      out += (i ? std::string(before, ' ') : std::string()) +
             (folds ? ends[r][i] : pad(ends[r][i], widths[last], last == 0)) + "\n";
  }
  for (const std::string& note : notes_) out += note + "\n";
  return out;
}

Json Table::json() const {
  Json rows = Json::array();
  for (const auto& cells : rows_) {
    Json row = Json::object();
    for (std::size_t c = 0; c < columns_.size(); ++c) row[columns_[c]] = cells[c];
    rows.push_back(row);
  }
  return Json{{"title", title_}, {"columns", columns_}, {"rows", rows}, {"notes", notes_}};
}

}  // namespace mocaplm
