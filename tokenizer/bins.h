// Scalar quantisation with bins of any width (thesis 4.4.1, Figure 4.4): a value becomes the number
// of its bin, a bin becomes one value. Fitted bins hold equally many values each and stand for the
// mean of theirs.
#pragma once

#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm {

class Bins {
 public:
  Bins() = default;
  // At most `count` bins of `values` (1 value or more, all finite), as equally filled as ties
  // allow: equal values (up to 1e-9) share a bin and no bin is empty, so there are exactly `count`
  // bins when there are as many different values, and a bin for each of them when there are fewer.
  static Bins quantile(std::vector<double> values, int count);
  // 2n bins at -n, ..., -1, 1, ..., n times `step` > 0: uniform without the one around 0, for
  // values whose zeros are told in another way.
  static Bins around_zero(double step, int n);

  // The bin of 0 stands for 0 itself: what rests stays.
  void keep_zero();

  int count() const { return static_cast<int>(centres_.size()); }
  // The bin of a value: that whose edges enclose it, an edge belonging to the bin above. Values
  // outside get the first or last bin.
  int of(double value) const {
    const double* first = edges_.data();
    for (std::size_t size = edges_.size(); size > 0;) {  // without a branch on the values
      const std::size_t half = size - size / 2;
      first += first[half - 1] <= value ? half : 0;
      size -= half;
    }
    return static_cast<int>(first - edges_.data());
  }
  // What a bin stands for; a number past the last bin stands for what the last one does.
  double centre(int bin) const {
    const auto b = static_cast<std::size_t>(bin);
    return b < centres_.size() ? centres_[b] : centres_.back();
  }
  // How far a value lies outside of all that were fitted, 0 inside (up to rounding). Bins that were
  // not fitted, and files written before the range was kept, have their outermost centres for it.
  double beyond(double value) const {
    return value < low_ - 1e-9 ? low_ - value : value > high_ + 1e-9 ? value - high_ : 0;
  }
  const std::vector<double>& edges() const { return edges_; }      // count() - 1, ascending
  const std::vector<double>& centres() const { return centres_; }  // count(), ascending

  // {"edges": [...], "centres": [...], "range": [low, high]}, exactly.
  Json to_json() const;
  // Throws DataError naming `place` and key unless these are between 1 and `most` bins in order.
  static Bins from_json(const Json& json, const std::string& place, int most);
  // All edges and centres with 17 digits, for fingerprints.
  std::string exact_text() const;

 private:
  std::vector<double> edges_, centres_;
  double low_ = 0, high_ = 0;  // smallest and largest value
};

// A bounded sample of a stream of rows: all of them while they are few, then every second, fourth,
// ... so that fitting on a large collection does not need it in memory.
class RowSample {
 public:
  explicit RowSample(std::size_t columns, std::size_t most_rows = 500000)
      : columns_(columns), most_rows_(most_rows) {}
  // `row` holds one value a column.
  template <class Row>
  void add(const Row& row) {
    if (seen_++ % stride_ != 0) return;
    for (auto& column : columns_)
      column.push_back(row[static_cast<int>(&column - columns_.data())]);
    if (columns_.front().size() > most_rows_) thin();
  }
  std::size_t columns() const { return columns_.size(); }
  const std::vector<double>& column(std::size_t index) const { return columns_[index]; }
  bool thinned() const { return stride_ > 1; }

 private:
  void thin();

  std::vector<std::vector<double>> columns_;
  std::size_t most_rows_, seen_ = 0, stride_ = 1;
};

}  // namespace mocaplm
