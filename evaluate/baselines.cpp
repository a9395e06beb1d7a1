#include "evaluate/baselines.h"

#include <algorithm>
#include <cassert>

namespace mocaplm {

BinMatrix stream_bins(const Tokenizer& tokenizer, const std::vector<std::int32_t>& ids) {
  tokenizer.check_frames(ids, "token stream");
  const int width = tokenizer.tokens_per_frame();
  BinMatrix bins(static_cast<Eigen::Index>(ids.size()) / width, tokenizer.channels());
  for (Eigen::Index t = 0; t < bins.rows(); ++t)
    for (Eigen::Index c = 0; c < bins.cols(); ++c)
      bins(t, c) = ids[static_cast<std::size_t>(t * width + c)] - Tokenizer::kFirstBin;
  return bins;
}

double BitCount::per_frame(int first, int count) const {
  assert(first >= 0 && count >= 0 && first + count <= static_cast<int>(bits.size()));
  double sum = 0;
  for (int c = first; c < first + count; ++c) sum += bits[static_cast<std::size_t>(c)];
  return frames > 0 ? sum / static_cast<double>(frames) : 0;
}

void BitCount::add(const BitCount& other) {
  if (bits.empty()) bits.resize(other.bits.size());
  assert(bits.size() == other.bits.size());
  for (std::size_t c = 0; c < bits.size(); ++c) bits[c] += other.bits[c];
  frames += other.frames;
}

Baselines::Baselines(int channels, int bins, double smoothing)
    : channels_(channels),
      bins_(bins),
      histograms_(static_cast<std::size_t>(kOrders * channels), Histogram(bins, smoothing)) {}

int Baselines::residual(int order, const BinMatrix& x, Eigen::Index t, Eigen::Index c) const {
  const int expected = order == 0 ? 0 : order == 1 ? x(t - 1, c) : 2 * x(t - 1, c) - x(t - 2, c);
  const int rest = (x(t, c) - expected) % bins_;
  return rest < 0 ? rest + bins_ : rest;
}

void Baselines::add(const BinMatrix& clip) {
  assert(clip.cols() == channels_);
  for (Eigen::Index t = 0; t < clip.rows(); ++t)
    for (int order = 0; order < kOrders && order <= t; ++order)
      for (int c = 0; c < channels_; ++c)
        histograms_[static_cast<std::size_t>(order * channels_ + c)].add(
            residual(order, clip, t, c));
}

BitCount Baselines::score(int order, const BinMatrix& clip, bool only_predicted) const {
  assert(order >= 0 && order < kOrders && clip.cols() == channels_);
  BitCount count;
  count.bits.resize(static_cast<std::size_t>(channels_));
  for (Eigen::Index t = only_predicted ? kOrders - 1 : 0; t < clip.rows(); ++t) {
    const int known = std::min<int>(order, static_cast<int>(std::min<Eigen::Index>(t, kOrders)));
    for (int c = 0; c < channels_; ++c)
      count.bits[static_cast<std::size_t>(c)] +=
          histograms_[static_cast<std::size_t>(known * channels_ + c)].bits(
              residual(known, clip, t, c));
    ++count.frames;
  }
  return count;
}

}  // namespace mocaplm
