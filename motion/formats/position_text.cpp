#include "motion/formats/position_text.h"

#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/bvh_number.h"

namespace mocaplm {

namespace {

std::string_view trimmed(std::string_view cell) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!cell.empty() && is_blank(cell.front())) cell.remove_prefix(1);
  while (!cell.empty() && is_blank(cell.back())) cell.remove_suffix(1);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
    cell = cell.substr(1, cell.size() - 2);
  return cell;
}

}  // namespace

TextLines::TextLines(std::string_view text) : text_(text) {
  if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
}

bool TextLines::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  const std::size_t end = text_.find_first_of("\r\n", at_);
  line = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
  at_ = end == std::string_view::npos    ? text_.size()
        : text_.substr(end, 2) == "\r\n" ? end + 2
                                         : end + 1;
  ++number_;
  return true;
}

std::vector<std::string_view> text_cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  for (std::size_t at = 0;;) {
    const std::size_t end = line.find(delimiter, at);
    cells.push_back(trimmed(line.substr(at, end == std::string_view::npos ? end : end - at)));
    if (end == std::string_view::npos) return cells;
    at = end + 1;
  }
}

double cell_number(std::string_view cell, const std::string& file, std::size_t line) {
  if (cell.empty()) return std::nan("");
  double value = 0;
  const char* end = parse_number(cell.data(), cell.data() + cell.size(), value);
  if (end != cell.data() + cell.size())
    throw DataError(at_line(file, line),
                    "has \"" + std::string(cell.substr(0, 40)) + "\" where a number was expected");
  if (std::isinf(value))
    throw DataError(at_line(file, line),
                    "has the infinite number \"" + std::string(cell.substr(0, 40)) + "\"");
  return value;
}

int cell_decimals(std::string_view cell) {
  const std::size_t point = cell.find('.');
  if (cell.find_first_of("eE") != std::string_view::npos) return 12;
  return point == std::string_view::npos ? 0 : static_cast<int>(cell.size() - point - 1);
}

}  // namespace mocaplm
