// Music as the dances need it: a name, a tempo, and smooth curves that follow its beats.
#pragma once

#include <string>

namespace mocaplm {

// One piece of music in AIST++'s naming: "mWA2" is the third tempo of waack.
struct Music {
  std::string name;
  double bpm = 0;  // beats per minute

  double beat_seconds() const { return 60 / bpm; }
};

// Pieces 0 to 5 of a genre run at 80, 90, ..., 130 beats per minute, those of house at 110, 115,
// ..., 135 (the tempi of the AIST dance database, Tsuchida et al. 2019).
Music music_of(const std::string& genre_code, int index);

// 0 at 0, 1 at 1, with no speed and no acceleration at either end; flat outside.
double ease(double x);

// How a movement goes back and forth between two poses, over `u` cycles; all return 0 to 1 and
// repeat with period 1. `attack` is the share of a cycle that the way there takes, in (0, 0.5].
double swing_curve(double u);                 // a pendulum
double hit_curve(double u, double attack);    // there on the beat, held, back on the half
double pulse_curve(double u, double attack);  // there on the beat, then let go slowly
double reach_curve(double u);                 // slowly there, held, slowly back

}  // namespace mocaplm
