// Movements whose coefficients are a known linear function of their ends, plus noise.
#pragma once

#include "common/random.h"
#include "gesture/model.h"

namespace mocaplm {

struct MadeUp {
  Recordings recordings;
  Eigen::MatrixXd f;  // (2 M, 5): of x and y, on start_x, start_y, end_x, end_y and 1
};

inline MadeUp made_up_movements(std::uint64_t seed, int count, double noise, int harmonics = 4,
                                Eigen::Index samples = 120) {
  Random random(seed);
  const Eigen::Index m = harmonics + 2;
  MadeUp made;
  made.recordings.source = "made up";
  made.recordings.coordinates = {"x", "y"};
  made.f = Eigen::MatrixXd::Zero(2 * m, 5);
  for (Eigen::Index v = 0; v < 2; ++v) {
    made.f(v * m, v) = 1;
    made.f(v * m + 1, v) = -1;
    made.f(v * m + 1, v + 2) = 1;
    for (Eigen::Index k = 2; k < m; ++k)
      for (Eigen::Index j = 0; j < 5; ++j) made.f(v * m + k, j) = 0.2 * random.normal();
  }
  const Eigen::MatrixXd table = Basis(harmonics).table(samples);
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd q(5);
    q << random.normal(), random.normal(), 2 + random.normal(), random.normal(), 1;
    Eigen::VectorXd p = made.f * q;
    for (Eigen::Index j = 0; j < p.size(); ++j)
      if (j % m > 1) p(j) += noise * random.normal();
    Recording one;
    one.name = "m" + std::to_string(i);
    one.time = Eigen::VectorXd::LinSpaced(samples, 0, random.uniform(0.5, 1.5));
    one.values = table * Eigen::Map<Eigen::MatrixXd>(p.data(), m, 2);
    one.more.resize(samples, 0);
    made.recordings.all.push_back(one);
  }
  return made;
}

inline GestureConfig made_up_config(int harmonics = 4) {
  GestureConfig config;
  config.harmonics = harmonics;
  config.samples = 120;
  return config;
}

inline Boundary boundary_between(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                                 double duration) {
  Boundary boundary;
  boundary.start = start;
  boundary.end = Eigen::VectorXd(end);
  boundary.duration = duration;
  return boundary;
}

}  // namespace mocaplm
