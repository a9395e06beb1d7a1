#include "spectral/filter.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "numeric/dct.h"
#include "spectral/measures.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kRowsAtOnce = 256;

void find_range(const Clip& clip, const FilterConfig& config, FilterResult& result) {
  const double step = clip.fps / (2 * static_cast<double>(clip.frames()));
  const bool band = config.keep == "band";
  if (band && config.from_hz >= config.to_hz)
    throw UsageError("from_hz is " + format_number(config.from_hz) + ", to_hz " +
                     format_number(config.to_hz) + ": the range must end above its beginning");
  // The small margin keeps a coefficient that lies on the border up to rounding.
  const double low = band ? std::ceil(config.from_hz / step - 1e-9) : 1;
  const double high = std::floor(config.to_hz / step + 1e-9) + 1;
  result.first = static_cast<Eigen::Index>(std::max(low, 1.0));
  result.last = static_cast<Eigen::Index>(std::min(high, static_cast<double>(clip.frames())));
  if (result.first >= result.last)
    throw UsageError("no frequency of this clip lies in the range: its " +
                     std::to_string(clip.frames()) + " frames have multiples of " +
                     format_fixed(step, 3) + " Hz up to " + format_number(clip.fps / 2));
}

}  // namespace

FilterResult filter_clip(const Clip& clip, const FilterConfig& config) {
  if (clip.frames() < 2)
    throw DataError(in_file(clip.name), "has one frame: there is no movement to filter");
  FilterResult result;
  find_range(clip, config, result);
  result.filtered = unwound(clip);
  Poses& poses = result.filtered.poses;
  Translations& trans = result.filtered.trans;
  const Eigen::RowVectorXd pose_mean = poses.colwise().mean();
  const Eigen::RowVectorXd trans_mean = trans.colwise().mean();
  const Eigen::MatrixXd pose = poses.rowwise() - pose_mean, path = trans.rowwise() - trans_mean;
  poses.rowwise() = pose_mean;
  trans.rowwise() = trans_mean;
  double kept = 0;
  for (Eigen::Index k = result.first; k < result.last; k += kRowsAtOnce) {
    const Eigen::MatrixXd rows = dct_rows(clip.frames(), k, std::min(kRowsAtOnce, result.last - k));
    const Eigen::MatrixXd coefficients = rows * pose;
    kept += coefficients.squaredNorm();
    poses += rows.transpose() * coefficients;
    trans += rows.transpose() * (rows * path);
  }
  const double all = pose.squaredNorm();
  result.kept_share = all > 1e-20 ? kept / all : 1;
  result.filtered = wound(result.filtered);
  return result;
}

Table filter_table(const Clip& clip, const FilterResult& result, const FilterConfig& config) {
  const std::string range =
      (config.keep == "band" ? format_number(config.from_hz) + " to " : "up to ") +
      format_number(config.to_hz) + " Hz";
  Table table(clip.name + ", " + range, {"motion", "roughness m/s^3", "above 8 Hz %"});
  table.digits({-1, 2, 3});
  table.row({"original", roughness(clip), 100 * fast_share(clip)});
  table.row({"filtered", roughness(result.filtered), 100 * fast_share(result.filtered)});
  const AngleApart apart = angle_apart(clip, result.filtered);
  table.note("DCT coefficients " + std::to_string(result.first) + " to " +
             std::to_string(result.last - 1) + " of " + std::to_string(clip.frames()) +
             " and the mean: " + format_fixed(100 * result.kept_share, 2) +
             " % of the rotations' movement");
  table.note("joints turn by " + format_fixed(apart.mean, 2) + " degrees on average, " +
             format_fixed(apart.most, 1) + " at most");
  return table;
}

}  // namespace mocaplm
