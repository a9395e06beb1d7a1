// Lines and cells of tables of numbers in text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mocaplm {

// One line after the other, whatever ends them; a byte order mark at the beginning is skipped.
class TextLines {
 public:
  explicit TextLines(std::string_view text);
  // False at the end of the text.
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  // of the line that `next` gave, from 1

 private:
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0;
};

// Cells between `delimiter`, without the blanks and quotes around them.
std::vector<std::string_view> text_cells(std::string_view line, char delimiter);

// A number, or nan for an empty cell and for "nan". Throws DataError naming the line for all else,
// infinite values among it.
double cell_number(std::string_view cell, const std::string& file, std::size_t line);

// Digits behind the decimal point.
int cell_decimals(std::string_view cell);

}  // namespace mocaplm
