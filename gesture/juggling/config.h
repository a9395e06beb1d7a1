// The settings of the ball juggling task (section III.A of Lippi, Avizzano and Ruffaldi 2012).
#pragma once

#include <cstdint>
#include <string>

namespace mocaplm {

struct JuggleConfig {
  std::int64_t demonstrations = 60;
  std::int64_t cycles = 200;
  std::int64_t seed = 1;
  double rate = 200;
  double gravity = 3;
  double toss_threshold = 6;
  double hand_radius = 0.05;
  double sensor_noise = 0.0003;
  double tracking_noise = 0.002;
  double gust = 0;
  double push = 0;
  std::string correction = "hyperplane";
  std::string toss_ends = "inversion";
  bool stop_toss = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("demonstrations", demonstrations, 1, 10000, "cycles that the made-up user shows");
    v.integer("cycles", cycles, 1, 1000000, "cycles that the model juggles");
    v.integer("seed", seed, 0, 1000000000, "of all chance");
    v.number("rate", rate, 50, 2000, "samples a second");
    v.number("gravity", gravity, 0.5, 20, "m/s2, of the virtual ball");
    v.number("toss_threshold", toss_threshold, 0.5, 100,
             "m/s2 downwards, from which on the ball leaves the hand");
    v.number("hand_radius", hand_radius, 0.005, 0.5, "m, at which the hand touches the ball");
    v.number("sensor_noise", sensor_noise, 0, 0.05, "m, of the tracker, in each sample");
    v.number("tracking_noise", tracking_noise, 0, 0.1,
             "m, how far the hand is from where it should be");
    v.number("gust", gust, 0, 5, "m/s, changes the ball's velocity once on the way to the catch");
    v.number("push", push, 0, 1, "m, moves the hand once on the way to the catch");
    v.choice("correction", correction, {"none", "minimum", "smooth", "hyperplane"},
             "how the catch is replanned (equation 10): not at all, moving the coefficients least, "
             "that without a jump of the speed, or on the hyperplane");
    v.choice("toss_ends", toss_ends, {"inversion", "toss"},
             "where the phase toss ends: where the hand turns down, or where the ball leaves it");
    v.boolean("stop_toss", stop_toss,
              "plan the toss with a vertical speed of zero at its end (equation 9)");
  }
};

}  // namespace mocaplm
