#include "spectral/frequencies.h"

#include <algorithm>
#include <cmath>

#include "numeric/dct.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kRowsAtOnce = 256;
constexpr double kBorder = 1e-9;  // of a step: what rounding may move a row that lies on the border

}  // namespace

RowRange rows_within(double from_hz, double to_hz, double step, Eigen::Index rows) {
  const auto most = static_cast<double>(rows);
  const double first = std::clamp(std::ceil(from_hz / step - kBorder), 0.0, most);
  const double last = std::clamp(std::floor(to_hz / step + kBorder) + 1, 0.0, most);
  return {static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last)};
}

void visit_dct_rows(
    Eigen::Index frames, RowRange range,
    const std::function<void(Eigen::Index first, const Eigen::MatrixXd& basis)>& visit) {
  for (Eigen::Index first = range.first; first < range.last; first += kRowsAtOnce)
    visit(first, dct_rows(frames, first, std::min(kRowsAtOnce, range.last - first)));
}

}  // namespace mocaplm
