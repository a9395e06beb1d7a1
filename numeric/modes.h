// Clusters around the modes of a sample, from the distances between its members: after Deng,
// Sarkar, Labruyere, Olivo-Marin and Srivastava 2022, "Characterizing Cell Populations Using
// Statistical Shape Modes" (ISBI). A mode is a member that has more others within epsilon than any
// member within epsilon of it: a local maximum of the density. Everything else belongs to its
// nearest mode.
//
// epsilon comes from the data: all of a grid are tried, and each is judged by the analysis of
// variance of its clusters, with squared distances in place of squares,
//   T = sum_{i<j} d^2 / N,  W = sum_k sum_{i<j in k} d^2 / n_k,  F = ((T-W)/(K-1)) / (W/(N-K)),
// and by the distribution of the number of modes over the grid: a number that only one epsilon
// gives is an accident. The paper's summary names these two criteria but not how it joins them;
// here the largest F wins among the numbers that `stable` neighbouring values of epsilon agree on.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocaplm {

struct ModeOptions {
  int grid = 48;           // values of epsilon that are tried: quantiles of the distances
  int stable = 2;          // neighbouring values that must find as many modes
  double smallest = 0.01;  // a mode has at least this share of the members within epsilon
  int most = 40;           // modes
  Eigen::Index count =
      0;  // ask for so many modes (the epsilon that comes nearest); 0: from the data
};

struct ModeTrial {
  double epsilon = 0;
  Eigen::Index modes = 0;
  double ratio = 0;  // F
};

struct Modes {
  std::vector<Eigen::Index> modes;  // members, those of most neighbours first
  std::vector<int> cluster;         // (n): index into modes
  double epsilon = 0, ratio = 0;
  std::vector<ModeTrial> trials;  // the whole grid, epsilon rising
};

// distance (n, n), symmetric with a zero diagonal. One member, or members that are all alike, have
// one mode. Throws DataError when it is not square, finite and nowhere negative.
Modes find_modes(const Eigen::MatrixXf& distance, const ModeOptions& options = {});

}  // namespace mocaplm
