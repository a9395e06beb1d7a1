// A movement from its boundaries (equations 7 and 8): 200 samples of three coordinates, 10 sines,
// six conditions. The peer is the plain loop over samples, coordinates and sines that the equations
// describe, with a sine worked out for each.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "common/angles.h"
#include "common/random.h"
#include "gesture/phase_model.h"

namespace {

using namespace mocaplm;

constexpr Eigen::Index kSamples = 200;

PhaseModel made_up_model() {
  Random random(1);
  PhaseModel model;
  model.name = "reach";
  model.coordinates = {"x", "y", "z"};
  model.conditions = {"start", "end"};
  model.harmonics = 10;
  model.f.resize(3 * model.size(), 7);
  for (Eigen::Index i = 0; i < model.f.size(); ++i) model.f(i) = random.normal();
  return model;
}

Boundary made_up_boundary() {
  return {Eigen::Vector3d(0.1, 0.2, 0.3), Eigen::VectorXd(Eigen::Vector3d(0.5, 0.1, 0.9)), 0.8, {}};
}

void plain(const PhaseModel& model, const Boundary& boundary, Eigen::MatrixXd& values) {
  const Eigen::VectorXd q = model.q(boundary);
  for (Eigen::Index v = 0; v < 3; ++v) {
    double p[12];
    for (Eigen::Index i = 0; i < 12; ++i) {
      p[i] = model.f(v * 12 + i, 6);
      for (Eigen::Index j = 0; j < 6; ++j) p[i] += model.f(v * 12 + i, j) * q(j);
    }
    p[0] = boundary.start(v);
    p[1] = (*boundary.end)(v)-boundary.start(v);
    for (Eigen::Index t = 0; t < kSamples; ++t) {
      const double tau = static_cast<double>(t) / static_cast<double>(kSamples - 1);
      double y = p[0] + p[1] * tau;
      for (int k = 1; k <= 10; ++k) y += p[k + 1] * std::sin(k * kPi * tau);
      values(t, v) = y;
    }
  }
}

// Movements a second of the plain loop.
double plain_rate(const PhaseModel& model, const Boundary& boundary, Eigen::MatrixXd& values) {
  double best = 0;
  for (int round = 0; round < 5; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 500; ++i) {
      plain(model, boundary, values);
      benchmark::DoNotOptimize(values.data());
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    best = std::max(best, 500 / seconds.count());
  }
  return best;
}

void generate(benchmark::State& state) {
  const PhaseModel model = made_up_model();
  const Boundary boundary = made_up_boundary();
  MovementWriter writer(model, kSamples);
  Eigen::MatrixXd values(kSamples, 3);
  const double peer = plain_rate(model, boundary, values);
  for (auto unused : state) {
    writer.write(boundary, values);
    benchmark::DoNotOptimize(values.data());
  }
  using benchmark::Counter;
  state.counters["movements/s"] = Counter(1, Counter::kIsIterationInvariantRate);
  state.counters["of a plain loop with sines"] =
      Counter(1 / peer, Counter::kIsIterationInvariantRate);
  state.counters["goal of value"] = 100000;  // under 10 microseconds each
  state.SetLabel("200 samples of three coordinates");
}

}  // namespace

BENCHMARK(generate)->Unit(benchmark::kMicrosecond);
