// Frequencies as rows of a transform, and the DCT of courses of any length.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace mocaplm {

struct RowRange {
  Eigen::Index first = 0, last = 0;  // [first, last)
  Eigen::Index count() const { return last - first; }
};

// Which of a transform's `rows` rows, row k at k * step Hz, lie in [from_hz, to_hz]; one on the
// border counts, up to rounding. Where none does, count() is 0 or less.
RowRange rows_within(double from_hz, double to_hz, double step, Eigen::Index rows);

// Hz from one DCT coefficient of `frames` frames to the next.
inline double dct_step(double fps, Eigen::Index frames) {
  return fps / (2 * static_cast<double>(frames));
}

// Calls visit(first, basis) with the DCT-II's rows (numeric/dct.h) of the range, some hundred at a
// time: the whole matrix of a minute of motion would be gigabytes.
void visit_dct_rows(
    Eigen::Index frames, RowRange range,
    const std::function<void(Eigen::Index first, const Eigen::MatrixXd& basis)>& visit);

}  // namespace mocaplm
