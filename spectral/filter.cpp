#include "spectral/filter.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "spectral/frequencies.h"
#include "spectral/measures.h"
#include "spectral/unwound.h"

namespace mocaplm {

namespace {

RowRange find_range(const Clip& clip, const FilterConfig& config) {
  const double step = dct_step(clip.fps, clip.frames());
  const bool band = config.keep == "band";
  if (band && config.from_hz >= config.to_hz)
    throw UsageError("from_hz is " + format_number(config.from_hz) + ", to_hz " +
                     format_number(config.to_hz) + ": the range must end above its beginning");
  RowRange range = rows_within(band ? config.from_hz : 0, config.to_hz, step, clip.frames());
  range.first = std::max<Eigen::Index>(range.first, 1);
  if (range.count() <= 0)
    throw UsageError("no frequency of this clip lies in the range: its " +
                     std::to_string(clip.frames()) + " frames have multiples of " +
                     format_fixed(step, 3) + " Hz up to " + format_number(clip.fps / 2));
  return range;
}

}  // namespace

FilterResult filter_clip(const Clip& clip, const FilterConfig& config) {
  if (clip.frames() < 2)
    throw DataError(in_file(clip.name), "has one frame: there is no movement to filter");
  FilterResult result;
  const RowRange range = find_range(clip, config);
  result.first = range.first;
  result.last = range.last;
  result.filtered = unwound(clip);
  Poses& poses = result.filtered.poses;
  Translations& trans = result.filtered.trans;
  const Eigen::RowVectorXd pose_mean = poses.colwise().mean();
  const Eigen::RowVectorXd trans_mean = trans.colwise().mean();
  const Eigen::MatrixXd pose = poses.rowwise() - pose_mean, path = trans.rowwise() - trans_mean;
  poses.rowwise() = pose_mean;
  trans.rowwise() = trans_mean;
  double kept = 0;
  visit_dct_rows(clip.frames(), range, [&](Eigen::Index, const Eigen::MatrixXd& basis) {
    const Eigen::MatrixXd coefficients = basis * pose;
    kept += coefficients.squaredNorm();
    poses += basis.transpose() * coefficients;
    trans += basis.transpose() * (basis * path);
  });
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
