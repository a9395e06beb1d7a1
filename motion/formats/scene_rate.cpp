#include "motion/formats/scene_rate.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"

namespace mocaplm {

namespace {

constexpr double kHighestRate = 240, kLowestRate = 23.9;
constexpr double kRates[] = {24, 25, 30, 48, 50, 60, 72, 75, 90, 100, 120, 144, 150, 180, 200, 240};
constexpr double kTelevision[] = {24 / 1.001, 30 / 1.001, 60 / 1.001, 120 / 1.001, 240 / 1.001};
constexpr double kTolerances[] = {1e-4, 6e-4};  // seconds
constexpr double kSameKey = 2e-5;               // 4-byte floats of some minutes

// All times lie on frames of this rate.
bool meets(const std::vector<double>& times, double begin, double fps, double tolerance) {
  return std::all_of(times.begin(), times.end(), [&](double time) {
    const double frame = (time - begin) * fps;
    return std::abs(frame - std::round(frame)) <= tolerance * fps;
  });
}

// The rate of keys in equal steps; 0 where they are not.
double equal_steps(const std::vector<double>& times) {
  const double steps = static_cast<double>(times.size() - 1);
  const double fps = steps / (times.back() - times.front());
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs((times[i] - times.front()) * fps - static_cast<double>(i)) >
        std::min(0.1, kTolerances[1] * fps))
      return 0;
  // A whole number or a television's, whichever puts the last key nearer to where it is, within a
  // twentieth of a frame; else thousandths.
  const auto error = [&](double rate) {
    return std::abs(steps / rate - (times.back() - times.front())) * rate;
  };
  const double whole = std::round(fps), television = std::round(fps * 1.001) / 1.001;
  const double nearer = whole > 0 && error(whole) <= error(television) ? whole : television;
  const double fine = std::round(fps * 1000) / 1000;
  for (const double rate : {nearer, fine})
    if (rate > 0 && error(rate) < 0.05) return rate;
  return fps;
}

double usual_key_rate(const std::vector<double>& times, double begin) {
  for (const double tolerance : kTolerances)
    for (const double most : kRates) {
      if (meets(times, begin, most, tolerance)) return most;
      for (const double fps : kTelevision)
        if (fps < most && most - fps < 1 && meets(times, begin, fps, tolerance)) return fps;
    }
  return 0;
}

}  // namespace

SceneRate scene_rate(std::vector<double> times, double begin, bool curves,
                     const std::string& take) {
  std::sort(times.begin(), times.end());
  times.erase(
      std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < kSameKey; }),
      times.end());
  SceneRate rate;
  const std::string name = take.empty() ? "the take" : "take \"" + take + "\"";
  if (times.size() < 2) {
    rate.fps = 30;
    return rate;
  }
  const double seconds = times.back() - times.front();
  const double keys = static_cast<double>(times.size() - 1) / seconds;
  rate.fps = times.size() > 2 || keys >= kLowestRate ? equal_steps(times) : 0;
  if (rate.fps > 0 && rate.fps < kLowestRate) rate.fps *= std::ceil(kLowestRate / rate.fps - 1e-9);
  // The steps may begin between two frames of a take that begins before them.
  if (rate.fps == 0 || !meets({times.front()}, begin, rate.fps, kTolerances[1]))
    rate.fps = usual_key_rate(times, begin);
  if (rate.fps > kHighestRate || rate.fps == 0) {
    rate.remarks.push_back(
        {"rate of keys", rate.fps > kHighestRate
                             ? name + " has " + format_number(std::round(rate.fps)) +
                                   " keys a second; it is read at " + format_number(kHighestRate)
                             : "the keys of " + name + " lie at no usual rate; it is read at " +
                                   format_number(kHighestRate) + " frames a second"});
    rate.fps = kHighestRate;
  } else if (curves && keys < 10) {
    rate.remarks.push_back({"few keys", name + " has " + format_fixed(keys, 1) +
                                            " keys a second, joined by straight lines; bake the "
                                            "animation for its curves"});
  }
  return rate;
}

}  // namespace mocaplm
