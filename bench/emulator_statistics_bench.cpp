// The statistics of emulated motions, beside plain loops: permutations of a two-sample test of 60
// against 60, whose plain version sums three blocks of the matrix each time; distances of 60
// motions of 300 postures of 23 limbs, beside std::acos of dot products on one core; and posture
// distances for the clusters.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "common/random.h"
#include "emulator/distances.h"
#include "numeric/energy.h"

namespace {

using namespace mocaplm;

std::vector<PostureSequence> random_sequences(std::size_t count, Eigen::Index limbs,
                                              Eigen::Index frames) {
  Random random(1);
  std::vector<PostureSequence> all(count);
  for (PostureSequence& one : all) {
    one.values.resize(3 * limbs, frames);
    for (Eigen::Index t = 0; t < frames; ++t)
      for (Eigen::Index i = 0; i < limbs; ++i)
        one.values.block<3, 1>(3 * i, t) =
            Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  }
  return all;
}

template <class Work>
double seconds_of(const Work& work) {
  double best = 1e9;
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

void report(benchmark::State& state, const char* unit, double count, double plain_rate,
            double goal) {
  using benchmark::Counter;
  state.counters[unit] = Counter(count, Counter::kIsIterationInvariantRate);
  state.counters["of a plain loop"] =
      Counter(count / plain_rate, Counter::kIsIterationInvariantRate);
  state.counters["goal of value"] = goal;
}

double plain_statistic(const Eigen::MatrixXd& d, const std::vector<std::size_t>& order) {
  const std::size_t half = order.size() / 2;
  double within_a = 0, within_b = 0, between = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = 0; j < order.size(); ++j) {
      const double value = d(Eigen::Index(order[i]), Eigen::Index(order[j]));
      (i < half ? (j < half ? within_a : between) : (j < half ? between : within_b)) += value;
    }
  const double n = double(half);
  return (between - within_a - within_b) / (n * n);
}

void permutations(benchmark::State& state) {
  Random random(2);
  Eigen::MatrixXd x(120, 3), d(120, 120);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
  for (Eigen::Index i = 0; i < 120; ++i)
    for (Eigen::Index j = 0; j < 120; ++j) d(i, j) = (x.row(i) - x.row(j)).norm();
  std::vector<std::size_t> order(120);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const double plain = 100 / seconds_of([&] {
                         for (int i = 0; i < 100; ++i) {
                           random.shuffle(order);
                           benchmark::DoNotOptimize(plain_statistic(d, order));
                         }
                       });
  EnergyOptions options;
  options.permutations = 1000;
  for (auto unused : state) benchmark::DoNotOptimize(energy_test(d, 60, options).p);
  report(state, "permutations/s", 1000, plain, 1000);
  state.SetLabel("permutations of 60 and 60");
}

double plain_distance(const PostureSequence& a, const PostureSequence& b) {
  double sum = 0;
  for (Eigen::Index i = 0; i < a.values.size(); i += 3) {
    const double *p = a.values.data() + i, *q = b.values.data() + i;
    sum += std::acos(std::clamp(p[0] * q[0] + p[1] * q[1] + p[2] * q[2], -1.0, 1.0));
  }
  return sum / double(a.frames());
}

void distances(benchmark::State& state) {
  const std::vector<PostureSequence> all = random_sequences(60, 23, 300);
  const double pairs = 60 * 59 / 2;
  const double plain = pairs / seconds_of([&] {
                         for (std::size_t i = 0; i < 60; ++i)
                           for (std::size_t j = 0; j < i; ++j)
                             benchmark::DoNotOptimize(plain_distance(all[i], all[j]));
                       });
  for (auto unused : state) benchmark::DoNotOptimize(sequence_distances(all, 0));
  report(state, "distances/s", pairs, plain, pairs);
  state.SetLabel("distances of 60 motions of 300 postures");
}

void posture_pairs(benchmark::State& state) {
  const std::vector<PostureSequence> all = random_sequences(1, 23, 2000);
  const double pairs = 2000 * 1999 / 2;
  std::vector<PostureSequence> single = random_sequences(200, 23, 1);
  const double plain = 200 * 199 / 2 / seconds_of([&] {
                         for (std::size_t i = 0; i < 200; ++i)
                           for (std::size_t j = 0; j < i; ++j)
                             benchmark::DoNotOptimize(plain_distance(single[i], single[j]));
                       });
  for (auto unused : state)
    benchmark::DoNotOptimize(posture_distances(PackedPostures::of_frames(all), 0));
  report(state, "distances/s", pairs, plain, pairs);
  state.SetLabel("distances of 2,000 postures");
}

}  // namespace

BENCHMARK(permutations)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(distances)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(posture_pairs)->Unit(benchmark::kMillisecond)->UseRealTime();
