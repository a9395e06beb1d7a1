// How movements become a model: the settings of `mocaplm gesture fit` and `test`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "numeric/linear_regression.h"

namespace mocaplm {

struct GestureConfig {
  std::vector<std::string> coordinates;  // empty: all
  std::vector<std::string> conditions = {"start", "end"};
  std::vector<std::string> phases;  // "NAME: RULE", see rule.h
  std::vector<std::string> leave_out;
  bool cycle = false;
  double min_seconds = 0.1;
  double window = 0.05;
  std::int64_t harmonics = 10;
  std::int64_t samples = 200;
  double ridge = 0;
  bool robust = false;

  RegressionOptions regression() const { return {ridge, robust}; }

  template <class Visitor>
  void describe(Visitor& v) {
    v.texts("coordinates", coordinates, "columns that move, comma separated; none: all");
    v.texts("conditions", conditions,
            "what a movement depends on: start, end, displacement, duration, or columns (their "
            "first value)");
    v.texts("phases", phases,
            "where recordings are cut, in order: NAME: RULE, comma separated; none: the column "
            "phase, or one phase");
    v.texts("leave_out", leave_out, "phases that get no model");
    v.boolean("cycle", cycle, "after the last phase comes the first one");
    v.number("min_seconds", min_seconds, 0, 100, "a phase lasts at least this long");
    v.number("window", window, 0.001, 10,
             "seconds of the past that give speed and acceleration (4 samples at least)");
    v.integer("harmonics", harmonics, 1, 200, "N, sines in the expansion");
    v.integer("samples", samples, 8, 4096, "samples that a movement is warped to");
    v.number("ridge", ridge, 0, 1e6, "shrinks the slopes of the regression; 0: least squares");
    v.boolean("robust", robust, "a regression that outliers do not move");
  }
};

}  // namespace mocaplm
