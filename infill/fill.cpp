#include "infill/fill.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/random.h"
#include "model/masked_input.h"

namespace mocaplm {

namespace {

constexpr double kHalfPi = 1.57079632679489661923;
constexpr std::size_t kAtOnce = 16;  // windows
constexpr std::int32_t kPad = 0;

struct Guess {
  std::size_t index;  // in the stream
  std::int32_t id;
  double confidence;  // the probability that the model gives it among the channel's bins
};

class Filler {
 public:
  Filler(LanguageModel& model, const std::vector<std::int32_t>& prefix, std::int32_t mask,
         const std::vector<int>& channel_bins, const FillOptions& options)
      : model_(model),
        prefix_(prefix),
        mask_(mask),
        channel_bins_(channel_bins),
        options_(options),
        random_(static_cast<std::uint64_t>(options.seed)),
        per_frame_(static_cast<std::size_t>(model.description().shape.tokens_per_frame())) {}

  // What the model would put in each hidden place now.
  std::vector<Guess> guess(const std::vector<std::int32_t>& ids) {
    std::vector<CentralWindow> windows;
    const auto room =
        static_cast<std::size_t>(model_.description().config.block_size) - prefix_.size();
    for (const CentralWindow& window : central_windows(ids.size() / per_frame_, room / per_frame_))
      if (std::find(at(ids, window.from), at(ids, window.to), mask_) != at(ids, window.to))
        windows.push_back(window);
    std::vector<Guess> guesses;
    for (std::size_t i = 0; i < windows.size(); i += kAtOnce)
      look(ids,
           {windows.begin() + static_cast<std::ptrdiff_t>(i),
            windows.begin() + static_cast<std::ptrdiff_t>(std::min(i + kAtOnce, windows.size()))},
           guesses);
    return guesses;
  }

 private:
  using Iterator = std::vector<std::int32_t>::const_iterator;
  Iterator at(const std::vector<std::int32_t>& ids, std::size_t frame) const {
    return ids.begin() + static_cast<std::ptrdiff_t>(frame * per_frame_);
  }

  void look(const std::vector<std::int32_t>& ids, const std::vector<CentralWindow>& windows,
            std::vector<Guess>& guesses) {
    const ModelDescription& d = model_.description();
    const auto length = static_cast<std::size_t>(tokens_in_window(d));
    std::vector<ModelInput> inputs;
    for (const CentralWindow& w : windows) {
      ModelInput input = masked_input(d, prefix_, {at(ids, w.first), at(ids, w.last)});
      while (input.size() < length) append_prefix(input, d, kPad, false, ids, 0);
      inputs.push_back(std::move(input));
    }
    const Batch batch = stack(inputs).to(model_.parameters().front().device());
    const at::Tensor logits = model_.logits(model_.hidden(batch), batch)
                                  .to(at::kCPU)
                                  .to(at::kFloat)
                                  .contiguous();  // (B, T, V)
    for (std::size_t w = 0; w < windows.size(); ++w)
      for (std::size_t i = windows[w].from * per_frame_; i < windows[w].to * per_frame_; ++i) {
        if (ids[i] != mask_) continue;
        const std::size_t position = prefix_.size() + i - windows[w].first * per_frame_;
        const float* row =
            logits.data_ptr<float>() +
            (static_cast<std::int64_t>(w) * logits.size(1) + static_cast<std::int64_t>(position)) *
                logits.size(2);
        guesses.push_back(choose(i, row + d.shape.first_bin));
      }
  }

  Guess choose(std::size_t index, const float* logits) {
    const auto bins = static_cast<std::size_t>(channel_bins_[index % per_frame_]);
    const float top = *std::max_element(logits, logits + bins);
    std::vector<double> weight(bins);
    double sum = 0, warm = 0;
    for (std::size_t b = 0; b < bins; ++b)
      sum += weight[b] = std::exp(static_cast<double>(logits[b] - top));
    std::size_t chosen =
        static_cast<std::size_t>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    if (options_.temperature > 0) {
      std::vector<double> cumulative;
      for (const double w : weight)
        cumulative.push_back(warm += std::pow(w, 1 / options_.temperature));
      chosen = static_cast<std::size_t>(
          std::upper_bound(cumulative.begin(), cumulative.end() - 1, random_.uniform() * warm) -
          cumulative.begin());
    }
    const auto first = static_cast<std::int32_t>(model_.description().shape.first_bin);
    return {index, first + static_cast<std::int32_t>(chosen), weight[chosen] / sum};
  }

  LanguageModel& model_;
  const std::vector<std::int32_t>& prefix_;
  std::int32_t mask_;
  const std::vector<int>& channel_bins_;
  FillOptions options_;
  Random random_;
  std::size_t per_frame_;
};

}  // namespace

std::vector<std::int32_t> fill_hidden(LanguageModel& model, const std::vector<std::int32_t>& prefix,
                                      std::vector<std::int32_t> ids, std::int32_t mask,
                                      const std::vector<int>& channel_bins,
                                      const FillOptions& options,
                                      const std::function<void(std::int64_t)>& round_done) {
  assert(model.description().masked());
  const at::NoGradGuard no_grad;
  model.eval();
  const auto all = static_cast<double>(std::count(ids.begin(), ids.end(), mask));
  Filler filler(model, prefix, mask, channel_bins, options);
  for (std::int64_t round = 1; round <= options.rounds; ++round) {
    std::vector<Guess> guesses = filler.guess(ids);
    const double share =
        std::cos(kHalfPi * static_cast<double>(round) / static_cast<double>(options.rounds));
    const auto left = round == options.rounds
                          ? std::size_t{0}
                          : std::min(guesses.size(), static_cast<std::size_t>(all * share));
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const Guess& a, const Guess& b) { return a.confidence > b.confidence; });
    for (std::size_t i = 0; i + left < guesses.size(); ++i) ids[guesses[i].index] = guesses[i].id;
    if (round_done) round_done(round);
  }
  return ids;
}

}  // namespace mocaplm
