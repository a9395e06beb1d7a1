#include "experiments/report.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

template <class Get>
bool differ(const std::vector<RowResult>& rows, const Get& get) {
  return std::any_of(rows.begin(), rows.end(),
                     [&](const RowResult& row) { return get(row) != get(rows.front()); });
}

template <class Get>
std::vector<std::string> in_order(const std::vector<RowResult>& rows, const Get& get) {
  std::vector<std::string> values;
  for (const RowResult& row : rows)
    if (std::find(values.begin(), values.end(), get(row)) == values.end())
      values.push_back(get(row));
  return values;
}

std::string headed(const std::string& column, const std::string& what) {
  return column.empty() ? what : column + " " + what;
}

Table thesis_form(const std::string& title, const std::vector<RowResult>& rows,
                  const std::vector<int>& shared) {
  const bool rates = differ(rows, [](const RowResult& r) { return r.fps; });
  const auto columns = in_order(rows, [](const RowResult& r) { return r.column; });
  std::vector<std::string> head = {""};
  std::vector<int> digits = {-1};
  for (const std::string& column : columns) {
    head.push_back(headed(column, "bits/frame"));
    if (rates) head.push_back(headed(column, "bits/s"));
    head.push_back(headed(column, "loss"));
    digits.insert(digits.end(), rates ? 3 : 2, rates ? 1 : 2);
    digits.back() = 3;
  }
  Table table(title, head);
  table.digits(digits);
  for (const std::string& line : in_order(rows, [](const RowResult& r) { return r.line; })) {
    std::vector<Json> cells = {line};
    for (const std::string& column : columns) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const RowResult& r) {
        return r.line == line && r.column == column;
      });
      const bool there = row != rows.end();
      const double bits = there ? bits_over(*row, row->bits, shared) : 0;
      cells.push_back(there ? Json(bits) : Json(nullptr));
      if (rates) cells.push_back(there ? Json(bits * row->fps) : Json(nullptr));
      cells.push_back(there ? Json(mean_loss(*row)) : Json(nullptr));
    }
    table.row(cells);
  }
  return table;
}

void add_notes(Table& table, const std::vector<RowResult>& rows, const std::vector<int>& shared,
               const std::string& split) {
  table.note("held-out clips (split " + split +
             "); bits/frame over the rotations that every row tells: " +
             std::to_string(shared.size()) + " joints, " + std::to_string(3 * shared.size()) +
             " channels; loss: nats of a predicted character, over all that the row tells");
  if (differ(rows, [](const RowResult& r) { return r.fps; }))
    table.note(
        "at different rates compare bits/s: a frame of a faster stream is nearer to the one "
        "before");
  if (differ(rows, [](const RowResult& r) { return std::make_pair(r.bins, r.binning); }))
    table.note("the bins differ: bits/frame are those of different values");
  if (differ(rows, [](const RowResult& r) { return r.masked; }))
    table.note(
        "a masked model sees what comes after, a causal one does not: their bits do not "
        "compare (the thesis says so too)");
}

Table details(const std::vector<RowResult>& rows, const std::vector<int>& shared) {
  Table table("each row", {"row", "bits/frame", "order 2", "own bits/frame", "own channels",
                           "frames/s", "bits/s", "loss", "parameters", "steps", "minutes"});
  table.digits({-1, 2, 2, 2, -1, -1, 1, 4, -1, -1, 1});
  for (const RowResult& r : rows) {
    double own = 0;
    for (std::size_t c = 0; c < r.order_2.size(); ++c) own += r.bits[c];
    const double bits = bits_over(r, r.bits, shared);
    table.row({r.name, bits, bits_over(r, r.order_2, shared), own, r.order_2.size(), r.fps,
               bits * r.fps, mean_loss(r), r.parameters, r.steps, r.minutes});
  }
  table.note(
      "order 2: histograms of the distance to the linear extrapolation, the same channels; "
      "own: all channels of the row's stream");
  return table;
}

Table accuracies(const std::string& title, const std::vector<RowResult>& rows,
                 const std::string& split) {
  std::vector<std::string> head = {"Method"};
  for (const auto& item : rows.front().accuracy.front().labels) head.push_back(item.first);
  Table table(title, head);
  std::vector<int> digits(head.size(), 1);
  digits[0] = -1;
  table.digits(digits);
  std::set<std::vector<Json>> known;  // baselines that look at the same windows are the same
  for (const RowResult& row : rows)
    for (const MethodAccuracy& method : row.accuracy) {
      const bool own = &method == &row.accuracy.back();
      std::vector<Json> cells = {own && rows.size() > 1 ? row.name : method.method};
      for (const auto& item : method.labels) cells.push_back(100 * item.second);
      if (known.insert(cells).second) table.row(cells);
    }
  table.note("accuracy of windows of the split " + split + ", %");
  return table;
}

}  // namespace

std::vector<int> shared_joints(const std::vector<RowResult>& rows) {
  std::vector<int> shared;
  for (const int joint : rows.front().joints)
    if (std::all_of(rows.begin(), rows.end(), [&](const RowResult& row) {
          return std::find(row.joints.begin(), row.joints.end(), joint) != row.joints.end();
        }))
      shared.push_back(joint);
  return shared;
}

double bits_over(const RowResult& row, const std::vector<double>& bits,
                 const std::vector<int>& joints) {
  double sum = 0;
  for (const int joint : joints) {
    const auto at = static_cast<std::size_t>(
        3 * (std::find(row.joints.begin(), row.joints.end(), joint) - row.joints.begin()));
    for (std::size_t axis = 0; axis < 3; ++axis) sum += bits.at(at + axis);
  }
  return sum;
}

double mean_loss(const RowResult& row) {
  double sum = 0;
  for (const double bits : row.bits) sum += bits;
  return sum * std::log(2.0) / static_cast<double>(std::max<std::int64_t>(row.predicted, 1));
}

std::vector<Table> experiment_tables(const std::string& title, const std::vector<RowResult>& rows,
                                     const std::string& split) {
  if (!rows.front().accuracy.empty()) return {accuracies(title, rows, split)};
  const std::vector<int> shared = shared_joints(rows);
  std::vector<Table> tables = {thesis_form(title, rows, shared), details(rows, shared)};
  add_notes(tables[0], rows, shared, split);
  return tables;
}

}  // namespace mocaplm
