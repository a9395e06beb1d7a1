// Sixty motions of 300 postures, 23 limbs each: fitting a scheme to them, aligning them, and
// sampling. Beside fitting: reading the motions once with one arc tangent an angle, the least that
// representing them costs. Beside aligning: the products of the fields alone, the least that
// dynamic programming over them needs.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "common/angles.h"
#include "emulator/align.h"
#include "emulator/emulator.h"
#include "emulator/representation.h"
#include "emulator/sphere.h"

namespace {

using namespace mocaplm;

constexpr Eigen::Index kLimbs = 23, kFrames = 300;
constexpr int kMotions = 60;

// Swings of a few sines about a posture; each motion has its own sizes and its own pace.
std::vector<PostureSequence> motions() {
  Random random(1);
  Posture centre(3, kLimbs);
  for (Eigen::Index i = 0; i < kLimbs; ++i)
    centre.col(i) = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  Eigen::MatrixXd phases(2 * kLimbs, 3);
  for (Eigen::Index i = 0; i < phases.size(); ++i) phases.data()[i] = random.uniform(0, 6);
  std::vector<PostureSequence> all;
  for (int m = 0; m < kMotions; ++m) {
    PostureSequence motion;
    motion.values.resize(3 * kLimbs, kFrames);
    Eigen::VectorXd sizes(2 * kLimbs);
    for (Eigen::Index i = 0; i < sizes.size(); ++i) sizes[i] = 0.3 + 0.05 * random.normal();
    const double bend = 0.05 * random.normal();
    for (Eigen::Index t = 0; t < kFrames; ++t) {
      const double x = static_cast<double>(t) / (kFrames - 1);
      const double time = x + bend * std::sin(2 * kPi * x);
      Eigen::VectorXd at(2 * kLimbs);
      for (Eigen::Index i = 0; i < at.size(); ++i)
        at[i] = sizes[i] * (std::sin(6 * time + phases(i, 0)) + std::sin(13 * time + phases(i, 1)));
      motion.at(t) = posture_exp(centre, tangent_vector(at, centre));
    }
    all.push_back(motion);
  }
  return all;
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return seconds.count();
}

double angles_seconds(const std::vector<PostureSequence>& all) {
  return seconds_of([&] {
    double sum = 0;
    for (const PostureSequence& motion : all) sum += sequence_distance(motion, all[0]);
    benchmark::DoNotOptimize(sum);
  });
}

void report(benchmark::State& state, const char* limit, double limit_seconds, double seconds,
            double goal_seconds) {
  using benchmark::Counter;
  state.counters["motions/s"] = Counter(kMotions, Counter::kIsIterationInvariantRate);
  state.counters[limit] = limit_seconds / seconds;
  state.counters["goal of value"] = kMotions / goal_seconds;
}

void fit(benchmark::State& state, const char* scheme) {
  const auto all = motions();
  double least = 1e9;
  for (auto unused : state)
    least = std::min(least, seconds_of([&] {
                       benchmark::DoNotOptimize(fit_emulator(all, parse_scheme(scheme), {}));
                     }));
  report(state, "of one angle each", angles_seconds(all), least, 2);
  state.SetLabel(std::string("fit ") + scheme + " to 60 motions of 300 postures");
}

void align(benchmark::State& state, const char* to) {
  const auto all = motions();
  AlignOptions options;
  options.align = to;
  double least = 1e9;
  for (auto unused : state)
    least = std::min(
        least, seconds_of([&] { benchmark::DoNotOptimize(align_all(all, kFrames, options)); }));
  const Posture reference = mean_posture(all, 1000);
  const Eigen::MatrixXd field = square_root_velocity(all[0], reference);
  const double products = seconds_of([&] {
    for (int m = 0; m < kMotions; ++m) {
      const Eigen::MatrixXd product = field.transpose() * field;
      benchmark::DoNotOptimize(product.data());
    }
  });
  report(state, "of their products", products, least, 30);
  state.SetLabel(std::string("align 60 motions of 300 postures to ") + to);
}

void sample(benchmark::State& state) {
  const auto all = motions();
  const auto emulator = fit_emulator(all, parse_scheme("SIEM/SequentialPCA/MVG"), {});
  double least = 1e9;
  for (auto unused : state)
    least = std::min(least,
                     seconds_of([&] { benchmark::DoNotOptimize(emulator->sample(kMotions, 1)); }));
  report(state, "of one angle each", angles_seconds(all), least, 2);
  state.SetLabel("sample 60 motions of 300 postures");
}

}  // namespace

BENCHMARK_CAPTURE(fit, mvg, "SIEM/SequentialPCA/MVG")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, is_tvf, "IS-TVF/SequentialPCA/MVG")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, mpca, "SIEM/MPCA/MVG")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit, local, "SIEM/SequentialPCA/Local")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(align, reference, "reference")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(align, mean, "mean")->Unit(benchmark::kMillisecond);
BENCHMARK(sample)->Unit(benchmark::kMillisecond);
