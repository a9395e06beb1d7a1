#include "train/range_test.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/files.h"
#include "common/progress.h"
#include "common/text.h"
#include "model/transformer/setup.h"
#include "train/batches.h"
#include "train/optimizer.h"
#include "train/setup.h"

namespace mocaplm {

namespace {

double mean(const std::vector<double>& values, std::size_t first, std::size_t last) {
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) sum += values[i];
  return sum / static_cast<double>(last - first);
}

std::vector<double> smoothed(const std::vector<double>& values) {
  const std::size_t reach = std::max<std::size_t>(values.size() / 20, 1);
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    // The same number on both sides, so that a slope is not bent at the ends.
    const std::size_t side = std::min({reach, i, values.size() - 1 - i});
    out.push_back(mean(values, i - side, i + side + 1));
  }
  return out;
}

// The last few losses against the first few.
bool diverged(const std::vector<double>& losses, std::size_t few) {
  if (!std::isfinite(losses.back())) return true;
  if (losses.size() < 2 * few) return false;
  return mean(losses, losses.size() - few, losses.size()) > 1.2 * mean(losses, 0, few);
}

void check(const RangeTestConfig& config) {
  if (config.range_high <= config.range_low)
    throw UsageError("--range-high must be above --range-low");
}

}  // namespace

RangeTestResult read_range(const std::vector<double>& rates, const std::vector<double>& losses) {
  RangeTestResult result;
  result.rates = rates;
  result.losses = losses;
  result.smooth = smoothed(losses);
  const auto& smooth = result.smooth;
  const auto low =
      static_cast<std::size_t>(std::min_element(smooth.begin(), smooth.end()) - smooth.begin());
  result.lowest = rates[low];
  const double drop = smooth.front() - smooth[low];
  result.rises = low + 1 < smooth.size() && smooth.back() > smooth[low] + 0.05 * std::abs(drop);
  double slope = 0;
  result.steepest = rates.front();
  for (std::size_t i = 1; i + 1 < smooth.size() && i <= low; ++i) {
    const double here =
        (smooth[i + 1] - smooth[i - 1]) / (std::log(rates[i + 1]) - std::log(rates[i - 1]));
    if (here < slope) {
      slope = here;
      result.steepest = rates[i];
    }
  }
  result.proposed = result.rises ? std::min(result.steepest, result.lowest / 10) : result.steepest;
  return result;
}

namespace {

void keep(const RangeTestResult& result, const TrainOptions& options) {
  save_json(options.out / "range_test.json", {{"config", to_json(options.config)},
                                              {"rates", result.rates},
                                              {"losses", result.losses},
                                              {"smoothed", result.smooth},
                                              {"steepest", result.steepest},
                                              {"lowest", result.lowest},
                                              {"rises", result.rises},
                                              {"proposed", result.proposed}});
}

}  // namespace

RangeTestResult range_test(const TrainOptions& options, const RangeTestConfig& config) {
  check(config);
  check_writable(options.out / "range_test.json");
  set_up_cpu(options.threads);
  const TrainSetup setup = set_up_training(options);
  const TrainConfig& train = setup.config.train;
  const at::Device device = choose_device(options.device);
  setup.model->to(device);
  setup.model->set_precision(choose_precision(train.precision, device));
  const WindowSampler sampler(setup.train, setup.description);
  Optimizer optimizer(*setup.model, train);
  Progress bar("range test", static_cast<std::size_t>(config.range_steps), "steps");
  const auto few = static_cast<std::size_t>(std::max<std::int64_t>(config.range_steps / 20, 3));
  const double times =
      std::log(config.range_high / config.range_low) / static_cast<double>(config.range_steps - 1);
  std::vector<double> rates, losses;
  for (std::int64_t step = 0; step < config.range_steps; ++step) {
    optimizer.zero_grad();
    const double rate = config.range_low * std::exp(times * static_cast<double>(step));
    const double nats = accumulate_gradient(*setup.model, draw_batches(sampler, train, step),
                                            device, step_seed(train.seed, step));
    if (!std::isfinite(nats)) break;
    rates.push_back(rate);
    losses.push_back(nats);
    const double norm = optimizer.step(rate);
    bar.update(static_cast<std::size_t>(step + 1),
               "rate " + format_number(rate) + ", loss " + format_fixed(nats, 3));
    if (diverged(losses, few) || !std::isfinite(norm)) break;
  }
  bar.finish();
  if (rates.size() < 10)
    throw DataError(
        in_file(options.out.string()),
        "the range test ended after " + std::to_string(rates.size()) + " steps: lower --range-low");
  const RangeTestResult result = read_range(rates, losses);
  keep(result, options);
  return result;
}

Table range_test_table(const RangeTestResult& result) {
  Table table("learning-rate range test", {"learning rate", "loss", "smoothed"});
  table.digits({-1, 3, 3});
  const std::size_t every = std::max<std::size_t>(result.rates.size() / 20, 1);
  for (std::size_t i = 0; i < result.rates.size(); i += every) {
    char rate[32];
    std::snprintf(rate, sizeof rate, "%.2e", result.rates[i]);
    table.row({rate, result.losses[i], result.smooth[i]});
  }
  char text[200];
  std::snprintf(text, sizeof text, "falls fastest at %.2e, is lowest at %.2e", result.steepest,
                result.lowest);
  table.note(text);
  if (!result.rises)
    table.note("the loss did not rise: with a higher --range-high the test says more");
  std::snprintf(text, sizeof text, "proposed: --learning-rate %.2g", result.proposed);
  table.note(text);
  return table;
}

}  // namespace mocaplm
