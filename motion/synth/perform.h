// From a choreography to the angles of every frame: the dancer's style, the music's beat, and the
// small wandering that no human movement is without.
#pragma once

#include <array>
#include <vector>

#include "motion/synth/beat.h"
#include "motion/synth/choreography.h"
#include "motion/synth/style.h"

namespace mocaplm {

TorsoPose operator+(const TorsoPose& a, const TorsoPose& b);
TorsoPose operator*(double s, const TorsoPose& a);

// One entry a frame.
struct Performance {
  double fps = 0;
  std::vector<TorsoPose> torso;
  std::array<std::vector<ArmPose>, 2> arms;
  FootPlan feet;
};

Performance perform(const std::vector<Move>& moves, const Genre& genre, const Style& style,
                    const Music& music, double fps, Eigen::Index frames, Random& random);

}  // namespace mocaplm
