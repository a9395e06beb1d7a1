#include "numeric/energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/error.h"
#include "common/random.h"
#include "common/text.h"

namespace mocaplm {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw DataError(in_file("two-sample test"), what);
}

void check_distances(const Eigen::MatrixXd& distance) {
  if (distance.rows() != distance.cols())
    refuse("the distances have " + std::to_string(distance.rows()) + " rows and " +
           std::to_string(distance.cols()) + " columns, expected as many of both");
  const double scale = distance.size() > 0 ? distance.cwiseAbs().maxCoeff() : 0;
  for (Eigen::Index i = 0; i < distance.rows(); ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double d = distance(i, j);
      const std::string place =
          "the distance of " + std::to_string(i) + " and " + std::to_string(j) + " is ";
      if (!std::isfinite(d) || !std::isfinite(distance(j, i))) refuse(place + "not finite");
      if (d < 0) refuse(place + format_number(d) + ", which is negative");
      if (std::abs(d - distance(j, i)) > 1e-9 * scale) refuse(place + "another one way than back");
      if (i == j && d > 1e-9 * scale) refuse(place + format_number(d) + ", expected 0");
    }
}

// The sum of the distances within a set of members, each pair once. Four sums at a time: one
// addition need not wait for the one before.
double pair_sum(const Eigen::MatrixXd& d, const Eigen::Index* members, Eigen::Index count) {
  double sums[4] = {0, 0, 0, 0};
  for (Eigen::Index i = 1; i < count; ++i) {
    const double* column = d.data() + members[i] * d.rows();
    Eigen::Index j = 0;
    for (; j + 4 <= i; j += 4)
      for (Eigen::Index k = 0; k < 4; ++k) sums[k] += column[members[j + k]];
    for (; j < i; ++j) sums[0] += column[members[j]];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// W of any division of the members into samples of given sizes.
class Within {
 public:
  Within(const Eigen::MatrixXd& d, std::vector<Eigen::Index> sizes)
      : d_(d), sizes_(std::move(sizes)), rows_(d.colwise().sum()), all_(rows_.sum() / 2) {}

  // Members in order: those of the first sample, then of the second, ... Of two samples only the
  // first is summed: what is within the second is all - (distances of the first to all) + (within
  // the first).
  double operator()(const std::vector<Eigen::Index>& order) const {
    const auto n = static_cast<double>(sizes_[0]);
    double sum = pair_sum(d_, order.data(), sizes_[0]);
    if (sizes_.size() == 2) {
      double to_all = 0;
      for (Eigen::Index i = 0; i < sizes_[0]; ++i) to_all += rows_[order[std::size_t(i)]];
      return sum / n + (all_ - to_all + sum) / static_cast<double>(sizes_[1]);
    }
    double within = sum / n;
    Eigen::Index begin = sizes_[0];
    for (std::size_t k = 1; k < sizes_.size(); begin += sizes_[k++])
      within += pair_sum(d_, order.data() + begin, sizes_[k]) / static_cast<double>(sizes_[k]);
    return within;
  }
  double total() const { return all_ / static_cast<double>(d_.rows()); }
  // How many leading members must be drawn for operator().
  Eigen::Index drawn() const { return sizes_.size() == 2 ? sizes_[0] : d_.rows(); }

 private:
  const Eigen::MatrixXd& d_;
  std::vector<Eigen::Index> sizes_;
  Eigen::VectorXd rows_;
  double all_;
};

// Rounding in sums of another order must not decide between equals.
double p_value(const Within& within, double observed, std::vector<Eigen::Index> order,
               const EnergyOptions& options) {
  Random random(options.seed);
  const double bound = observed + 1e-12 * within.total();
  const auto n = static_cast<std::uint64_t>(order.size());
  const auto drawn = static_cast<std::size_t>(within.drawn());
  std::int64_t as_extreme = 0;
  for (std::int64_t k = 0; k < options.permutations; ++k) {
    for (std::size_t i = 0; i < drawn && i + 1 < n; ++i)
      std::swap(order[i], order[i + random.below(n - i)]);
    if (within(order) <= bound) ++as_extreme;
  }
  return static_cast<double>(1 + as_extreme) / static_cast<double>(1 + options.permutations);
}

}  // namespace

EnergyTest disco_test(const Eigen::MatrixXd& distance, const std::vector<int>& groups,
                      const EnergyOptions& options) {
  if (!(options.alpha > 0 && options.alpha <= 2))
    throw UsageError("alpha " + format_number(options.alpha) +
                     " of a two-sample test, expected "
                     "more than 0 and at most 2");
  if (options.permutations < 1) throw UsageError("a permutation test needs a permutation at least");
  check_distances(distance);
  if (static_cast<Eigen::Index>(groups.size()) != distance.rows())
    refuse(std::to_string(groups.size()) + " members for " + std::to_string(distance.rows()) +
           " rows of distances");
  const int count = groups.empty() ? 0 : *std::max_element(groups.begin(), groups.end()) + 1;
  if (count < 2) refuse("there is one sample only, expected two or more");

  // Samples by size, the smallest first: it is the one that is summed of two.
  std::vector<std::vector<Eigen::Index>> members(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] < 0) refuse("member " + std::to_string(i) + " belongs to a negative sample");
    members[static_cast<std::size_t>(groups[i])].push_back(static_cast<Eigen::Index>(i));
  }
  std::stable_sort(members.begin(), members.end(),
                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (members[0].empty()) refuse("a sample is empty");
  std::vector<Eigen::Index> order, sizes;
  for (const auto& sample : members) {
    order.insert(order.end(), sample.begin(), sample.end());
    sizes.push_back(static_cast<Eigen::Index>(sample.size()));
  }

  Eigen::MatrixXd powers;
  if (options.alpha != 1) powers = distance.array().pow(options.alpha).matrix();
  const Within within(options.alpha == 1 ? distance : powers, sizes);
  EnergyTest test;
  test.within = within(order);
  const double between = std::max(0.0, within.total() - test.within);
  const auto n = static_cast<double>(groups.size());
  const double freedom = n - count;
  test.ratio = test.within > 0 && freedom > 0 ? between / (count - 1) / (test.within / freedom)
               : between > 0                  ? std::numeric_limits<double>::infinity()
                                              : 0;
  test.statistic = between;
  if (count == 2)
    test.statistic *= 2 * n / (static_cast<double>(sizes[0]) * static_cast<double>(sizes[1]));
  test.p = p_value(within, test.within, std::move(order), options);
  return test;
}

EnergyTest energy_test(const Eigen::MatrixXd& distance, Eigen::Index first,
                       const EnergyOptions& options) {
  if (first < 1 || first >= distance.rows())
    refuse("samples of " + std::to_string(first) + " and " +
           std::to_string(distance.rows() - first) + " members, expected one or more in each");
  std::vector<int> groups(static_cast<std::size_t>(distance.rows()), 1);
  std::fill_n(groups.begin(), first, 0);
  return disco_test(distance, groups, options);
}

}  // namespace mocaplm
