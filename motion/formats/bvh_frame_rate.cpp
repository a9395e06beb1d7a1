#include "motion/formats/bvh_frame_rate.h"

#include <charconv>
#include <cmath>
#include <optional>

namespace mocaplm {

namespace {

// The rates of cameras, suits and screens. Where few digits fit several, the first of them: the
// more common one.
constexpr double kUsualRates[] = {30, 60,  120, 24,  25, 50,  100, 240, 90,  15, 20, 200, 144,
                                  72, 150, 180, 360, 10, 300, 480, 75,  500, 12, 48, 80,  1000};

// What one step of the last digit is worth, seconds: 0.001 of "0.017" and of "17e-3".
double last_digit(std::string_view digits) {
  const std::size_t e = digits.find_first_of("eE");
  const std::string_view mantissa = digits.substr(0, e);
  int power = 0;
  if (e != digits.npos) {
    const std::size_t sign = e + 1 < digits.size() && digits[e + 1] == '+';
    std::from_chars(digits.data() + e + 1 + sign, digits.data() + digits.size(), power);
  }
  const std::size_t point = mantissa.find('.');
  if (point != mantissa.npos) power -= static_cast<int>(mantissa.size() - point - 1);
  return std::pow(10, power);
}

std::optional<double> usual_rate(double seconds, double step) {
  for (const double rate : kUsualRates)
    if (std::abs(rate * seconds - 1) < 1e-9) return rate;
  for (const double rate : kUsualRates)
    if (std::abs(1 / rate - seconds) <= 0.5 * step * (1 + 1e-6)) return rate;
  for (const double rate : kUsualRates)
    if (1 / rate >= seconds && 1 / rate < seconds + step) return rate;
  return std::nullopt;
}

}  // namespace

FrameRate frame_rate(double seconds, std::string_view digits) {
  const double step = last_digit(digits), rate = 1 / seconds;
  // 30 and 29.97, 24 and 23.976 are a thousandth apart: so fine must the digits be to be sure.
  const bool coarse = 0.5 * step > 1e-3 * seconds;
  const auto guessed = [&](double fps) {
    return std::abs(fps * seconds - 1) > (coarse ? 1e-9 : 1e-3);
  };
  if (const std::optional<double> usual = usual_rate(seconds, step))
    return {*usual, guessed(*usual)};
  const double whole = std::round(rate), fine = std::round(rate * 1000) / 1000;
  if (whole > 0 && std::abs(1 / whole - seconds) <= std::max(step, 1e-9 * seconds) &&
      std::abs(whole - rate) < 2e-3 * rate)
    return {whole, guessed(whole)};
  return {std::abs(fine - rate) <= 1e-9 * rate ? fine : rate, false};
}

}  // namespace mocaplm
