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
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t widest = width(columns_[c]);
    for (const auto& cells : rows_) widest = std::max(widest, width(cell(c, cells[c])));
    widths.push_back(widest);
  }
  std::string out = title_.empty() ? "" : title_ + "\n";
  std::string rule;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    out += (c ? "  " : "") + pad(columns_[c], widths[c], c == 0);
    rule += (c ? "  " : "") + std::string(widths[c], '-');
  }
  out += "\n" + rule + "\n";
  for (const auto& cells : rows_) {
    for (std::size_t c = 0; c < columns_.size(); ++c)
      out += (c ? "  " : "") + pad(cell(c, cells[c]), widths[c], c == 0);
    out += "\n";
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
