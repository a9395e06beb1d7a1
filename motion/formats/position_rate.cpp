#include "motion/formats/position_rate.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// How far the times are from even ones at this rate, at most, and where.
double unevenness(const std::vector<double>& times, double rate, std::size_t& worst) {
  double most = 0;
  for (std::size_t t = 0; t < times.size(); ++t) {
    const double off = std::abs(times[t] - times[0] - static_cast<double>(t) / rate);
    if (off <= most) continue;
    most = off;
    worst = t;
  }
  return most;
}

}  // namespace

std::optional<double> rate_of_times(const std::vector<double>& times, int decimals,
                                    const std::string& file, std::vector<Remark>& remarks) {
  if (times.size() < 2) return std::nullopt;
  for (std::size_t t = 0; t < times.size(); ++t)
    if (!std::isfinite(times[t]) || (t > 0 && !(times[t] > times[t - 1])))
      throw DataError(at_frame(file, t), "has the time " + format_number(times[t]) +
                                             ", expected one later than that of the frame before");
  const double mean = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  std::size_t worst = 0;
  // The first time is rounded as well.
  const double rounded = 1.02 * std::pow(10.0, -std::clamp(decimals, 0, 12)) + 1e-12;
  for (int digits = 0; digits <= 4; ++digits) {
    const double scale = std::pow(10.0, digits), rate = std::round(mean * scale) / scale;
    if (rate > 0 && unevenness(times, rate, worst) <= rounded) return rate;
  }
  // NTSC's rates, whole ones by 1.001.
  const double ntsc = std::round(mean * 1.001) / 1.001;
  if (unevenness(times, ntsc, worst) <= rounded) return ntsc;
  const double off = unevenness(times, mean, worst);
  if (off > 0.75 / mean)
    throw DataError(at_frame(file, worst),
                    "has the time " + format_number(times[worst]) + ", " + format_fixed(off, 3) +
                        " s off an even rate of " + format_fixed(mean, 2) +
                        " frames per second: frames are missing, or the rate changes");
  if (off > rounded)
    remarks.push_back({"frame rate", "times are uneven; their mean rate of " +
                                         format_fixed(mean, 3) + " is taken"});
  return mean;
}

}  // namespace mocaplm
