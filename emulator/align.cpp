#include "emulator/align.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/parallel.h"
#include "emulator/distances.h"
#include "emulator/representation.h"

namespace mocaplm {

namespace {

// A way for the warping over q intervals of the fixed field and p of the moved one, split where
// either goes on to its next interval.
struct Slope {
  struct Piece {
    Eigen::Index moved, fixed;  // intervals from the slope's beginning
    double length;              // in the fixed field's intervals
  };
  Eigen::Index p, q;
  double root;  // of p / q
  std::vector<Piece> pieces;
};

Slope make_slope(Eigen::Index p, Eigen::Index q) {
  Slope slope{p, q, std::sqrt(static_cast<double>(p) / static_cast<double>(q)), {}};
  // In units of 1 / p of a fixed interval: its ends are at multiples of p, the moved one's of q.
  for (Eigen::Index at = 0; at < p * q;) {
    const Eigen::Index next = std::min((at / p + 1) * p, (at / q + 1) * q);
    slope.pieces.push_back(
        {at / q, at / p, static_cast<double>(next - at) / static_cast<double>(p)});
    at = next;
  }
  return slope;
}

// The diagonal first: it is taken where others are no better.
std::vector<Slope> make_slopes(Eigen::Index steepest) {
  std::vector<Slope> slopes = {make_slope(1, 1)};
  for (Eigen::Index p = 1; p <= steepest; ++p)
    for (Eigen::Index q = 1; q <= steepest; ++q)
      if (p != q && std::gcd(p, q) == 1) slopes.push_back(make_slope(p, q));
  return slopes;
}

// Where |fixed|^2 and |moved|^2 g' are left out, whose integrals no warping changes.
struct WarpingTable {
  Eigen::MatrixXd cost;  // (n + 1, n + 1), moved by fixed
  Eigen::MatrixXi way;   // the slope that leads there
};

WarpingTable fill_table(const Eigen::MatrixXd& products, const std::vector<Slope>& slopes,
                        double stiffness) {
  const Eigen::Index n = products.rows();
  WarpingTable table;
  table.cost.setConstant(n + 1, n + 1, std::numeric_limits<double>::infinity());
  table.way.setZero(n + 1, n + 1);
  table.cost(0, 0) = 0;
  Eigen::ArrayXd sum(n + 1);
  for (Eigen::Index j = 1; j <= n; ++j)
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const Slope& slope = slopes[k];
      if (slope.q > j || slope.p > n) continue;
      const Eigen::Index count = n + 1 - slope.p;
      const double bend =
          stiffness * static_cast<double>(slope.q) * (slope.root - 1) * (slope.root - 1);
      sum.head(count) = table.cost.col(j - slope.q).head(count).array() + bend;
      for (const Slope::Piece& piece : slope.pieces)
        sum.head(count) -=
            (2 * slope.root * piece.length) *
            products.col(j - slope.q + piece.fixed).segment(piece.moved, count).array();
      double* best = table.cost.col(j).data() + slope.p;
      int* way = table.way.col(j).data() + slope.p;
      for (Eigen::Index i = 0; i < count; ++i)
        if (sum[i] < best[i]) {
          best[i] = sum[i];
          way[i] = static_cast<int>(k);
        }
    }
  return table;
}

// integral |fixed - moved(g) sqrt(g')|^2, exactly.
double field_distance(const Eigen::MatrixXd& fixed, const Eigen::MatrixXd& moved,
                      const Eigen::VectorXd& warping) {
  const Eigen::Index n = fixed.cols();
  double sum = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double slope = warping[j + 1] - warping[j];
    for (double at = warping[j]; at < warping[j + 1] - 1e-12;) {
      const auto i = std::min(static_cast<Eigen::Index>(at + 1e-12), n - 1);
      const double next = std::min(warping[j + 1], static_cast<double>(i + 1));
      sum += (next - at) / slope * (fixed.col(j) - std::sqrt(slope) * moved.col(i)).squaredNorm();
      at = next;
    }
  }
  return std::sqrt(sum / static_cast<double>(n));
}

double warping_amount(const Eigen::VectorXd& warping) {
  const Eigen::Index n = warping.size() - 1;
  double sum = 0;
  for (Eigen::Index j = 0; j < n; ++j) sum += std::sqrt(warping[j + 1] - warping[j]);
  return std::acos(std::min(1.0, sum / static_cast<double>(n)));
}

// The times at which a strictly increasing warping is 0, 1, ... n.
Eigen::VectorXd inverse(const Eigen::VectorXd& warping) {
  const Eigen::Index n = warping.size() - 1;
  Eigen::VectorXd times(n + 1);
  Eigen::Index j = 0;
  for (Eigen::Index i = 0; i <= n; ++i) {
    while (j + 1 < n && warping[j + 1] < static_cast<double>(i)) ++j;
    times[i] = static_cast<double>(j) +
               (static_cast<double>(i) - warping[j]) / (warping[j + 1] - warping[j]);
  }
  return times.cwiseMax(0).cwiseMin(static_cast<double>(n));
}

void check_all(const std::vector<PostureSequence>& sequences, Eigen::Index frames,
               std::size_t reference) {
  if (frames < 2) throw UsageError("aligned sequences need 2 frames or more");
  if (reference >= sequences.size()) throw UsageError("there are no sequences to align");
  for (std::size_t m = 0; m < sequences.size(); ++m) {
    check_sequence(sequences[m], in_file("sequence " + std::to_string(m)));
    if (sequences[m].limbs() != sequences[0].limbs())
      throw UsageError("sequences of different limbs cannot be aligned");
  }
}

}  // namespace

Eigen::MatrixXd square_root_velocity(const PostureSequence& sequence, const Posture& reference) {
  const Eigen::Index n = sequence.frames() - 1;
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(2 * sequence.limbs(), n);
  for (Eigen::Index t = 0; t < n; ++t) {
    const PostureTangent velocity =
        static_cast<double>(n) * posture_log(sequence.at(t), sequence.at(t + 1));
    const double speed = velocity.norm();
    if (speed == 0) continue;
    field.col(t) =
        tangent_coordinates(posture_transport(velocity, sequence.at(t), reference), reference) /
        std::sqrt(speed);
  }
  return field;
}

Eigen::VectorXd best_warping(const Eigen::MatrixXd& fixed, const Eigen::MatrixXd& moved,
                             const AlignOptions& options, double* cost) {
  const Eigen::Index n = fixed.cols();
  if (moved.cols() != n || n == 0 || moved.rows() != fixed.rows())
    throw UsageError("fields to be aligned must have the same intervals and coordinates");
  const std::vector<Slope> slopes = make_slopes(options.steepest);
  const Eigen::MatrixXd products = moved.transpose() * fixed;
  const WarpingTable table = fill_table(products, slopes, options.stiffness);
  if (cost != nullptr)
    *cost = (fixed.squaredNorm() + moved.squaredNorm() + table.cost(n, n)) / static_cast<double>(n);
  Eigen::VectorXd warping(n + 1);
  Eigen::Index i = n, j = n;
  warping[n] = static_cast<double>(n);
  while (j > 0) {
    const Slope& slope = slopes[static_cast<std::size_t>(table.way(i, j))];
    for (Eigen::Index back = 1; back <= slope.q; ++back)
      warping[j - back] = static_cast<double>(i) -
                          static_cast<double>(back * slope.p) / static_cast<double>(slope.q);
    i -= slope.p;
    j -= slope.q;
  }
  return warping;
}

Alignment align_to(const PostureSequence& sequence, const PostureSequence& fixed,
                   const Posture& reference, const AlignOptions& options) {
  const Eigen::Index frames = fixed.frames();
  const double n = static_cast<double>(frames - 1);
  const Eigen::MatrixXd still = square_root_velocity(fixed, reference);
  const Eigen::MatrixXd moved = square_root_velocity(normalised(sequence, frames), reference);
  const Eigen::VectorXd even = Eigen::VectorXd::LinSpaced(frames, 0, n);
  Alignment alignment;
  alignment.warping = options.align == "none" ? even : best_warping(still, moved, options);
  alignment.before = field_distance(still, moved, even);
  alignment.after = field_distance(still, moved, alignment.warping);
  alignment.amount = warping_amount(alignment.warping);
  alignment.warping /= n;
  // Read from the sequence itself, not from the normalised one: once, not twice.
  alignment.sequence =
      read_at(sequence, alignment.warping * static_cast<double>(sequence.frames() - 1));
  return alignment;
}

Aligned align_all(const std::vector<PostureSequence>& sequences, Eigen::Index frames,
                  const AlignOptions& options, std::size_t reference, int threads) {
  check_all(sequences, frames, reference);
  Aligned aligned;
  aligned.items.resize(sequences.size());
  aligned.reference = mean_posture(sequences, 4000);
  aligned.fixed = normalised(sequences[reference], frames);
  const auto align = [&] {
    parallel_for(sequences.size(), threads, [&](std::size_t m) {
      aligned.items[m] = align_to(sequences[m], aligned.fixed, aligned.reference, options);
    });
  };
  align();
  const auto mean = [&] {
    std::vector<PostureSequence> all;
    for (const Alignment& item : aligned.items) all.push_back(item.sequence);
    return mean_sequence(all, threads);
  };
  if (options.align == "none") aligned.fixed = mean();
  if (options.align != "mean") return aligned;
  for (std::int64_t round = 0; round < options.iterations; ++round) {
    Eigen::VectorXd warping = Eigen::VectorXd::Zero(frames);
    for (const Alignment& item : aligned.items) warping += item.warping;
    warping *= static_cast<double>(frames - 1) / static_cast<double>(sequences.size());
    aligned.fixed = read_at(mean(), inverse(warping));
    align();
  }
  return aligned;
}

std::size_t central_sequence(const std::vector<PostureSequence>& sequences, Eigen::Index frames,
                             int threads) {
  // Which one it is hardly depends on every frame.
  std::vector<PostureSequence> even;
  for (const PostureSequence& sequence : sequences)
    even.push_back(normalised(sequence, std::min<Eigen::Index>(frames, 50)));
  Eigen::Index least = 0;
  if (!even.empty()) sequence_distances(even, threads).rowwise().sum().minCoeff(&least);
  return static_cast<std::size_t>(least);
}

}  // namespace mocaplm
