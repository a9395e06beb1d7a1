#include "tokenizer/bins.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

namespace mocaplm {

namespace {

constexpr double kEqual = 1e-9;  // values this close are the same: rounding, not motion

// One value that occurs, with how often.
struct Group {
  double first, last, sum;
  std::size_t count;
};

std::vector<Group> groups_of(const std::vector<double>& sorted) {
  std::vector<Group> groups;
  for (const double value : sorted) {
    if (groups.empty() || value - groups.back().first > kEqual)
      groups.push_back({value, value, 0, 0});
    Group& group = groups.back();
    group.last = value;
    group.sum += value;
    ++group.count;
  }
  return groups;
}

// Numbers in the JSON are exact: the shortest text that reads back the same.
bool ascending(const std::vector<double>& values) {
  return std::adjacent_find(values.begin(), values.end(),
                            [](double a, double b) { return !(a < b); }) == values.end();
}

}  // namespace

Bins Bins::quantile(std::vector<double> values, int count) {
  assert(!values.empty() && count >= 1);
  std::sort(values.begin(), values.end());
  const std::vector<Group> groups = groups_of(values);
  Bins bins;
  bins.low_ = values.front();
  bins.high_ = values.back();
  std::size_t left = values.size(), next = 0;
  for (int b = 0; b < count && next < groups.size(); ++b) {
    // What is left is shared out among the bins that are left, each of which needs a group.
    const auto bins_left = static_cast<std::size_t>(count - b);
    const double share = static_cast<double>(left) / static_cast<double>(bins_left);
    Group bin = groups[next++];
    while (next < groups.size() && groups.size() - next >= bins_left) {
      const Group& more = groups[next];
      // The last bin takes the rest; the others stop where they are nearest to their share.
      if (bins_left > 1 &&
          static_cast<double>(bin.count) + 0.5 * static_cast<double>(more.count) > share)
        break;
      bin.last = more.last;
      bin.sum += more.sum;
      bin.count += more.count;
      ++next;
    }
    left -= bin.count;
    bins.centres_.push_back(
        std::clamp(bin.sum / static_cast<double>(bin.count), bin.first, bin.last));
    if (next < groups.size()) {
      const double above = groups[next].first;
      const double edge = bin.last + 0.5 * (above - bin.last);
      bins.edges_.push_back(edge > bin.last ? edge : above);
    }
  }
  return bins;
}

Bins Bins::around_zero(double step, int n) {
  assert(step > 0 && n >= 1);
  Bins bins;
  for (int k = -n; k <= n; ++k) {
    if (k != 0) bins.centres_.push_back(k * step);
    if (k < n && k != 0) bins.edges_.push_back(k == -1 ? 0.0 : (k + 0.5) * step);
  }
  bins.low_ = bins.centres_.front();
  bins.high_ = bins.centres_.back();
  return bins;
}

void Bins::keep_zero() {
  centres_[static_cast<std::size_t>(of(0))] = 0;
}

Json Bins::to_json() const {
  return {{"edges", edges_}, {"centres", centres_}, {"range", {low_, high_}}};
}

Bins Bins::from_json(const Json& json, const std::string& place, int most) {
  JsonObject object(json, place);
  Bins bins;
  bins.edges_ = object.numbers("edges");
  bins.centres_ = object.numbers("centres");
  std::vector<double> range;
  if (object.has("range")) range = object.numbers("range");
  const bool ranged = object.has("range");
  object.finish();
  const std::size_t count = bins.centres_.size();
  if (count < 1 || count > static_cast<std::size_t>(most) || !ascending(bins.centres_))
    object.fail("centres", "expected 1 to " + std::to_string(most) + " ascending numbers");
  if (bins.edges_.size() + 1 != count || !ascending(bins.edges_))
    object.fail("edges", "expected " + std::to_string(count - 1) +
                             " ascending numbers, one between each two centres");
  for (std::size_t b = 0; b + 1 < count; ++b)
    if (!(bins.centres_[b] < bins.edges_[b] && bins.edges_[b] <= bins.centres_[b + 1]))
      object.fail("edges", "edge " + std::to_string(b) + " does not lie between its two centres");
  if (!ranged) range = {bins.centres_.front(), bins.centres_.back()};
  if (range.size() != 2 || !(range[0] <= range[1]))
    object.fail("range", "expected [low, high], low not above high");
  bins.low_ = range[0];
  bins.high_ = range[1];
  return bins;
}

std::string Bins::exact_text() const {
  std::string text = std::to_string(count()) + " bins";
  char buffer[32];
  for (const auto* numbers : {&edges_, &centres_})
    for (const double number : *numbers) {
      std::snprintf(buffer, sizeof buffer, " %.17g", number);
      text += buffer;
    }
  return text;
}

void RowSample::thin() {
  for (auto& column : columns_) {
    for (std::size_t i = 0; 2 * i < column.size(); ++i) column[i] = column[2 * i];
    column.resize((column.size() + 1) / 2);
  }
  stride_ *= 2;
}

}  // namespace mocaplm
