// The simple models that a language model of motion must beat: histograms of each channel's bins,
// of their changes, and of their distance to the linear extrapolation. Lengths in bits, the
// thesis's measure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "numeric/histogram.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// (frames, channels) bins 0 .. bins-1.
using BinMatrix = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The bins of a stream of whole frames, without the separators. Throws DataError naming frame and
// channel otherwise.
BinMatrix stream_bins(const Tokenizer& tokenizer, const std::vector<std::int32_t>& ids);

// Bits spent on some frames. The separator is certain and costs nothing.
struct BitCount {
  std::int64_t frames = 0;
  std::vector<double> bits;  // sum over the frames, per channel

  // Mean over the frames of the sum over channels [first, first + count); 0 without frames.
  double per_frame(int first, int count) const;
  double per_frame() const { return per_frame(0, static_cast<int>(bits.size())); }
  void add(const BitCount& other);
};

class Baselines {
 public:
  static constexpr int kOrders = 3;

  // `smoothing`: how often every outcome counts as seen before anything is. On an hour of motion
  // 0.1 is near the best; 1 costs about half a bit a frame.
  Baselines(int channels, int bins, double smoothing = 0.1);

  // Counts a training clip. No order looks across a clip's border.
  void add(const BinMatrix& clip);

  // order 0: x[t]; 1: x[t] - x[t-1]; 2: x[t] - (2 x[t-1] - x[t-2]); per channel, modulo the number
  // of bins (angles are circular, and every outcome is a valid bin). A clip's first frame has order
  // 0, its second at most order 1; `only_predicted` leaves these two out, so that all orders are
  // judged on the same frames with their full past.
  BitCount score(int order, const BinMatrix& clip, bool only_predicted = false) const;

 private:
  // What order `order` codes at (t, c), in 0 .. bins-1.
  int residual(int order, const BinMatrix& clip, Eigen::Index t, Eigen::Index c) const;

  int channels_, bins_;
  std::vector<Histogram> histograms_;  // [order * channels + channel]
};

}  // namespace mocaplm
