#include "motion/synth/beat.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"

namespace mocaplm {

namespace {

double fraction(double u) {
  return u - std::floor(u);
}

}  // namespace

Music music_of(const std::string& genre_code, int index) {
  const double bpm = genre_code == "HO" ? 110 + 5 * index : 80 + 10 * index;
  return {"m" + genre_code + std::to_string(index), bpm};
}

double ease(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

double swing_curve(double u) {
  return 0.5 - 0.5 * std::cos(kTurn * u);
}

double hit_curve(double u, double attack) {
  const double at = fraction(u);
  return ease(at / attack) - ease((at - 0.5) / attack);
}

double pulse_curve(double u, double attack) {
  const double at = fraction(u);
  return ease(at / attack) - ease((at - attack) / (1 - attack));
}

double reach_curve(double u) {
  return hit_curve(u, 0.36);
}

}  // namespace mocaplm
