// Choreographies: phrases of moves that a genre's vocabulary gives and a random stream chooses.
#pragma once

#include <vector>

#include "common/random.h"
#include "motion/synth/vocabulary.h"

namespace mocaplm {

// Some beats of one figure each for arms, torso and feet.
struct Move {
  ArmFigure arms;
  TorsoFigure torso;
  FootFigure feet;
  double beats = 4;
  double size = 1;       // of arms and torso
  bool flipped = false;  // left and right changed
  bool freeze = false;   // stands still during its last beat
};

// basic: two moves, repeated plainly, then on the other side. advanced: five to seven moves of
// changing length and size, with turns, double time and combinations that come back varied.
enum class Situation { basic, advanced };

// At least `beats` beats of dance.
std::vector<Move> compose(const Genre& genre, Situation situation, double beats, Random& random);

}  // namespace mocaplm
