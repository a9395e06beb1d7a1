#include "motion/synth/style.h"

#include <cassert>
#include <vector>

#include "common/random.h"

namespace mocaplm {

namespace {

// Each number of a style with the distance between neighbouring dancers.
struct Trait {
  double Style::*field;
  double spread;
};

const std::vector<Trait>& traits() {
  static const std::vector<Trait> all = {
      {&Style::amplitude, 0.15}, {&Style::asymmetry, 0.12}, {&Style::reach, 0.14},
      {&Style::elbow, 0.14},     {&Style::sharpness, 0.15}, {&Style::bounce, 0.25},
      {&Style::posture, 0.07},   {&Style::lean, 0.03},      {&Style::chin, 0.07},
      {&Style::follow, 0.05},    {&Style::bend, 0.012},     {&Style::timing, 0.03},
      {&Style::width, 0.018},    {&Style::turnout, 0.08},   {&Style::step_scale, 0.12}};
  return all;
}

}  // namespace

Style dancer_style(std::uint64_t seed, const std::string& genre_code, int dancer) {
  assert(dancer >= 0 && dancer < 3);
  Random random(stable_hash("style of " + genre_code, seed));
  Style style;
  for (const Trait& trait : traits()) {
    // One dancer is low, one in the middle, one high in each trait: no two are alike in all.
    std::vector<double> levels = {-1, 0, 1};
    random.shuffle(levels);
    for (double& level : levels) level += 0.3 * random.uniform(-1, 1);
    style.*trait.field += trait.spread * levels[static_cast<std::size_t>(dancer)];
  }
  return style;
}

Style on_the_day(const Style& style, std::uint64_t clip_seed) {
  Random random(stable_hash("day", clip_seed));
  Style today = style;
  for (const Trait& trait : traits()) today.*trait.field += 0.45 * trait.spread * random.normal();
  return today;
}

}  // namespace mocaplm
