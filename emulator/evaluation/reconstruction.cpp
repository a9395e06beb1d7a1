#include "emulator/evaluation/reconstruction.h"

#include <algorithm>
#include <memory>

#include "common/parallel.h"

namespace mocaplm {

namespace {

using Eigen::Index;

// Reconstructions are compared with their originals one by one, not all with all.
double mean_distance(const std::vector<PostureSequence>& a, const std::vector<PostureSequence>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += cross_distances({a[i]}, {b[i]}, 1)(0, 0);
  return sum / static_cast<double>(a.size());
}

}  // namespace

double reconstruction_error(const Emulator& emulator, const std::vector<PostureSequence>& sequences,
                            Eigen::Index d1, Eigen::Index d2, int threads,
                            std::vector<PostureSequence>* rebuilt) {
  std::vector<PostureSequence> again(sequences.size());
  parallel_for(sequences.size(), threads,
               [&](std::size_t i) { again[i] = emulator.reconstruct(sequences[i], d1, d2); });
  const double error = mean_distance(sequences, again);
  if (rebuilt) *rebuilt = std::move(again);
  return error;
}

ReconstructionCurve reconstruction_curve(const ClassMotions& motions, const Scheme& scheme,
                                         const SchemeTestOptions& options,
                                         const std::vector<Eigen::Index>& d1,
                                         const std::vector<Eigen::Index>& d2) {
  SchemeOptions largest = options.scheme;
  largest.d1 = *std::max_element(d1.begin(), d1.end());
  largest.d2 = *std::max_element(d2.begin(), d2.end());
  largest.variance1 = largest.variance2 = 0;
  const std::unique_ptr<Emulator> emulator =
      fit_emulator(motions.fit(), scheme, largest, options.threads);
  ReconstructionCurve curve;
  curve.representation = scheme.representation + "/" + scheme.reduction;
  for (const Index first : d1)
    for (const Index second : d2) {
      if (first > emulator->d1() || second > emulator->d2()) continue;
      ReconstructionPoint point;
      point.d1 = first;
      point.d2 = second;
      std::vector<PostureSequence> rebuilt;
      point.fit = reconstruction_error(*emulator, motions.fit(), first, second, options.threads);
      point.unseen =
          reconstruction_error(*emulator, motions.test(), first, second, options.threads, &rebuilt);
      const PackedPostures packed(rebuilt);
      const Eigen::MatrixXd between =
          cross_distances(packed, motions.packed_test(), options.threads);
      point.p = energy_test(joined_distances(sequence_distances(packed, options.threads),
                                             motions.test_distances(), between),
                            packed.count(), options.energy)
                    .p;
      curve.points.push_back(point);
    }
  return curve;
}

}  // namespace mocaplm
