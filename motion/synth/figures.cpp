#include <algorithm>

#include "common/error.h"
#include "motion/synth/vocabulary.h"

namespace mocaplm {

namespace {

// Arm poses are {raise, forward, twist, bend, wrist}, see arms.h.
const std::vector<ArmFigure>& arm_figures() {
  static const std::vector<ArmFigure> all = {
      {"swing",
       Curve::swing,
       Hands::alternate,
       {-1.2, 0.0, 0.0, 0.35, 0},
       {-0.9, 0.9, 0.1, 1.0, 0.1},
       0.5},
      {"wave",
       Curve::wave,
       Hands::canon,
       {-0.35, 0.1, 0.2, 0.2, -0.4},
       {0.35, 0.2, -0.7, 1.0, 0.5},
       0.5},
      {"circle",
       Curve::circle,
       Hands::alternate,
       {0.1, 0.4, -0.5, 1.1, 0},
       {0.85, 0.75, 0.5, 0.6, 0.3},
       0.5},
      {"low-circle",
       Curve::circle,
       Hands::both,
       {-0.7, 0.5, 0.0, 0.8, 0},
       {0.4, 0.6, 0.4, 0.4, 0.2},
       0.5},
      {"overhead",
       Curve::hit,
       Hands::alternate,
       {0.9, 0.1, -1.2, 2.1, 0.3},
       {0.1, 0.3, 0.0, 0.35, -0.2},
       0.5},
      {"hit-down",
       Curve::hit,
       Hands::both,
       {0.3, 0.9, -0.9, 1.5, 0},
       {-0.9, 1.0, 0.2, 0.5, 0.2},
       0.5},
      {"chest-arms",
       Curve::pulse,
       Hands::both,
       {-0.9, 0.2, 0.0, 0.9, 0},
       {-0.4, 0.5, -0.5, 1.7, 0.2},
       1},
      {"jab",
       Curve::pulse,
       Hands::alternate,
       {-0.7, 0.6, -0.4, 2.0, 0},
       {-0.1, 1.3, 0.0, 0.25, 0},
       0.5},
      {"point", Curve::hit, Hands::lead, {-0.6, 0.5, -0.5, 1.8, 0}, {0.3, 0.6, 0.0, 0.15, 0}, 0.25},
      {"twirl",
       Curve::circle,
       Hands::both,
       {-0.3, 0.7, -0.5, 1.4, 0},
       {0.25, 0.3, 0.5, 0.4, 0.6},
       1},
      {"robot",
       Curve::hit,
       Hands::alternate,
       {-0.2, 0.1, 0.9, 1.4, 0.3},
       {-0.1, 0.2, -0.9, 1.5, -0.2},
       0.5},
      {"long-line",
       Curve::reach,
       Hands::alternate,
       {-0.8, 0.6, 0.1, 0.5, 0.2},
       {0.8, 0.2, 0.0, 0.15, -0.2},
       0.25},
      {"port-de-bras",
       Curve::reach,
       Hands::both,
       {-0.8, 0.9, 0.4, 0.8, 0.2},
       {1.0, 0.6, -0.4, 0.8, -0.1},
       0.25},
      {"cross",
       Curve::swing,
       Hands::both,
       {-0.4, 1.2, -0.2, 1.7, 0.1},
       {-0.5, 0.0, 0.0, 0.35, -0.1},
       0.5},
      {"guard",
       Curve::swing,
       Hands::alternate,
       {-0.6, 1.1, -0.1, 1.5, 0.1},
       {-0.5, 0.1, 0.1, 0.5, 0},
       0.5},
      {"frame",
       Curve::hit,
       Hands::canon,
       {0.4, 0.3, -1.0, 1.7, 0},
       {-0.5, 0.4, 0.7, 1.2, 0.3},
       0.5}};
  return all;
}

TorsoFigure torso(std::string name, Curve curve, double rate, double lag, TorsoPose amount) {
  return {std::move(name), curve, amount, rate, lag};
}

// Amounts: {pitch, roll, twist, nod, look, down, sway left, front, hip roll, twist, pitch, heel}.
const std::vector<TorsoFigure>& torso_figures() {
  static const std::vector<TorsoFigure> all = {
      torso("bounce", Curve::swing, 1, 0.05, {0.08, 0, 0, 0.12, 0, 0.055, 0, 0, 0, 0, 0.05, 0}),
      torso("rock", Curve::swing, 0.5, 0.1, {0.14, 0, 0.1, 0.1, 0, 0.04, 0, 0.05, 0, 0.1, 0.08, 0}),
      torso("roll", Curve::swing, 0.5, 0.2, {0.28, 0.05, 0, 0.2, 0, 0.05, 0, 0.04, 0, 0, 0.14, 0}),
      torso("twist", Curve::swing, 0.5, 0.12, {0.04, 0, 0.4, 0, 0.2, 0.03, 0, 0, 0, -0.22, 0, 0}),
      torso("pop", Curve::pulse, 1, 0.03, {-0.16, 0, 0.05, 0.08, 0, 0.03, 0, 0.015, 0, 0, 0.08, 0}),
      torso("sway", Curve::swing, 0.5, 0.1, {0, 0.18, 0, 0, 0.1, 0.03, 0.05, 0, -0.12, 0, 0, 0}),
      torso("long", Curve::reach, 0.25, 0.05,
            {-0.12, 0.2, 0.2, -0.1, 0.35, -0.01, 0, 0, 0, 0.1, 0, 0.3})};
  return all;
}

// Steps: {beat, foot, out, front, move left, move front, turn, lift, kick}.
const std::vector<FootFigure>& foot_figures() {
  constexpr double quarter = 0.7853981633974483;
  static const std::vector<FootFigure> all = {
      {"plant",
       8,
       0.03,
       {{1, 0, 0.08, 0.02}, {2, 1, 0.08, 0.0}, {5, 0, 0.12, 0.08}, {6, 1, 0.1, -0.04}}},
      {"step-touch",
       4,
       0.01,
       {{0, 0, 0.12, 0, 0.25}, {1, 1, -0.02, 0.02}, {2, 1, 0.12, 0, -0.25}, {3, 0, -0.02, 0.02}}},
      {"march", 2, 0.0, {{0, 0, 0.02, 0.03, 0, 0, 0, 0.16}, {1, 1, 0.02, 0.03, 0, 0, 0, 0.16}}},
      {"rock-step",
       4,
       0.01,
       {{0, 0, 0.03, 0.22}, {1, 1, 0.03, 0}, {2, 0, 0.03, -0.2}, {3, 1, 0.03, 0.05}}},
      {"shuffle",
       2,
       0.02,
       {{0, 0, 0.03, 0.1, 0.05},
        {0.5, 1, -0.02, -0.08},
        {1, 0, 0.1, 0},
        {1.5, 1, 0.06, 0.1, -0.05}}},
      {"cross-step",
       4,
       0.01,
       {{0, 0, 0.1, 0, 0.22}, {1, 1, -0.22, -0.13}, {2, 0, 0.1, 0, 0.1}, {3, 1, 0.05, 0.05}}},
      {"pivot",
       4,
       0.0,
       {{0, 0, 0.02, 0.12, 0, 0.1},
        {1, 1, 0.04, 0, 0, 0, quarter},
        {2, 0, 0.04, 0, 0, 0, quarter},
        {3, 1, 0, 0.04}}},
      {"kick",
       4,
       0.0,
       {{0, 0, 0.02, 0.05, 0, 0, 0, 0.12, 0.28},
        {1, 1, 0.05, -0.1},
        {2, 1, 0.02, 0.05, 0, 0, 0, 0.12, 0.28},
        {3, 0, 0.05, -0.1}}},
      {"lunge", 4, 0.02, {{0, 0, 0.2, 0.14, 0.1}, {2, 0, 0.02, 0, -0.1}, {3, 1, 0.03, 0.02}}},
      {"stomp", 2, 0.03, {{0, 0, 0.14, 0.1, 0, 0, 0, 0.2}, {1, 1, 0.14, 0.02, 0, 0, 0, 0.2}}},
      {"toprock",
       4,
       0.01,
       {{0, 0, -0.16, 0.2, 0, 0, 0, 0.12},
        {1, 0, 0.05, -0.02},
        {2, 1, -0.16, 0.2, 0, 0, 0, 0.12},
        {3, 1, 0.05, -0.02}}}};
  return all;
}

template <class Figure>
const Figure& named(const std::vector<Figure>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Figure& f) { return f.name == name; });
  if (found == all.end()) throw UsageError("no movement figure is called \"" + name + "\"");
  return *found;
}

}  // namespace

const ArmFigure& arm_figure(const std::string& name) {
  return named(arm_figures(), name);
}

const TorsoFigure& torso_figure(const std::string& name) {
  return named(torso_figures(), name);
}

const FootFigure& foot_figure(const std::string& name) {
  return named(foot_figures(), name);
}

}  // namespace mocaplm
