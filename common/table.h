// A table that a command prints, and the same table as JSON.
#pragma once

#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm {

class Table {
 public:
  // The first column is left-aligned, the others right-aligned.
  explicit Table(std::string title, std::vector<std::string> columns);

  // Cells are texts, numbers or null; numbers print with `digits` (per column, -1: shortest).
  void row(std::vector<Json> cells);
  void digits(std::vector<int> digits) { digits_ = std::move(digits); }
  void note(std::string text) { notes_.push_back(std::move(text)); }

  // Lines wider than 100 characters are folded in the last column, at spaces.
  std::string text() const;
  // {"title": ..., "columns": [...], "rows": [{column: value}], "notes": [...]}
  Json json() const;
  const std::string& title() const { return title_; }
  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<std::vector<Json>>& rows() const { return rows_; }
  const std::vector<std::string>& notes() const { return notes_; }
  // One value as text() prints it in that column.
  std::string cell(std::size_t column, const Json& value) const;

 private:
  std::string title_;
  std::vector<std::string> columns_;
  std::vector<int> digits_;
  std::vector<std::vector<Json>> rows_;
  std::vector<std::string> notes_;
};

}  // namespace mocaplm
