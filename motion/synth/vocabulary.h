// The movement vocabulary: figures of arms, torso and feet, and which of them a genre uses how
// often. Most figures belong to several genres; what tells a genre is which go together, and how
// sharply.
#pragma once

#include <string>
#include <vector>

#include "motion/synth/arms.h"
#include "motion/synth/feet.h"

namespace mocaplm {

// Torso, head and hips: radians, and metres for `down` and the sways.
struct TorsoPose {
  double pitch = 0;  // chest forward
  double roll = 0;   // chest to the right
  double twist = 0;  // chest to the left
  double nod = 0;    // head down
  double look = 0;   // head to the left
  double down = 0;   // pelvis lower
  double sway_left = 0, sway_front = 0;
  double hip_roll = 0, hip_twist = 0, hip_pitch = 0;
  double heel = 0;  // standing foot on its toes
};

struct TorsoFigure {
  std::string name;
  Curve curve = Curve::swing;
  TorsoPose amount;  // at the end of the way
  double rate = 1;   // cycles a beat
  double lag = 0;    // cycles by which chest and head follow the pelvis
};

struct Genre {
  std::string code;      // "WA"
  std::string name;      // as aist_labels says it
  int first_dancer = 1;  // the genre's three dancers are numbered from here
  double bend = 0.03;    // how low it is danced, metres
  double attack = 0.2;   // seconds that a hit takes
  double drive = 1;      // size of the torso's movement
  double freeze = 0;     // share of moves after which the dancer stands still for a beat
  double turning = 0.3;  // share of moves that turn the heading
  std::vector<std::pair<std::string, double>> arms, torsos, feet;  // figure, weight
};

// The ten genres of AIST++ in the order BR PO LO MH LH HO WA KR JS JB.
const std::vector<Genre>& genres();
// Throw UsageError with the nearest known code, or for a name that no figure has.
const Genre& genre_by_code(const std::string& code);

const ArmFigure& arm_figure(const std::string& name);
const TorsoFigure& torso_figure(const std::string& name);
const FootFigure& foot_figure(const std::string& name);

}  // namespace mocaplm
