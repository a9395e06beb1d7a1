#include "motion/formats/position_gaps.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

struct PointGap {
  Eigen::Index first = 0, last = 0;  // frames
  Eigen::Index frames() const { return last - first + 1; }
};

std::vector<PointGap> gaps_of(const PointTracks& tracks, int point) {
  std::vector<PointGap> gaps;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t) {
    if (tracks.at(t, point).allFinite()) continue;
    if (!gaps.empty() && gaps.back().last == t - 1)
      gaps.back().last = t;
    else
      gaps.push_back({t, t});
  }
  return gaps;
}

bool is_needed(int point) {
  const auto& needed = needed_points();
  return std::find(needed.begin(), needed.end(), point) != needed.end();
}

void fill_gap(PointTracks& tracks, int point, const PointGap& gap) {
  const Eigen::Index before = gap.first - 1, after = gap.last + 1;
  const bool has_before = before >= 0, has_after = after < tracks.frames();
  const Eigen::Vector3d from = tracks.at(has_before ? before : after, point),
                        to = tracks.at(has_after ? after : before, point);
  for (Eigen::Index t = gap.first; t <= gap.last; ++t) {
    const double share = static_cast<double>(t - before) /
                         static_cast<double>(std::max<Eigen::Index>(1, after - before));
    tracks.places.row(t).segment<3>(3 * point) = ((1 - share) * from + share * to).transpose();
  }
}

std::string length_text(const PointGap& gap, double fps) {
  return std::to_string(gap.frames()) + (gap.frames() == 1 ? " frame (" : " frames (") +
         format_fixed(static_cast<double>(gap.frames()) / fps, 2) + " s)";
}

}  // namespace

void close_gaps(PointTracks& tracks, bool fill, const std::string& file,
                std::vector<Remark>& remarks) {
  std::vector<std::string> dropped;
  Eigen::Index filled = 0, longest = 0;
  for (int point = 0; point < kPoints; ++point) {
    const auto at = static_cast<std::size_t>(point);
    if (!tracks.given[at]) continue;
    const std::vector<PointGap> gaps = gaps_of(tracks, point);
    if (gaps.empty()) continue;
    const auto worst = std::max_element(
        gaps.begin(), gaps.end(),
        [](const PointGap& a, const PointGap& b) { return a.frames() < b.frames(); });
    const bool too_long =
        static_cast<double>(worst->frames()) > tracks.fps || worst->frames() == tracks.frames();
    if (too_long && !is_needed(point)) {
      tracks.given[at] = false;
      dropped.push_back(point_name(point));
      continue;
    }
    if (too_long)
      throw DataError(at_joint(file, static_cast<std::size_t>(worst->first), point_name(point)),
                      "has no position (nan, empty or 0 0 0) for " +
                          length_text(*worst, tracks.fps) +
                          ", more than the second that can be filled: cut the file there");
    if (!fill)
      throw DataError(
          at_joint(file, static_cast<std::size_t>(gaps.front().first), point_name(point)),
          "has no position (nan, empty or 0 0 0) for " + length_text(gaps.front(), tracks.fps) +
              "; with --fill-gaps places are interpolated over up to a second");
    for (const PointGap& gap : gaps) {
      fill_gap(tracks, point, gap);
      filled += gap.frames();
      longest = std::max(longest, gap.frames());
    }
  }
  if (filled > 0)
    remarks.push_back({"gaps filled", std::to_string(filled) +
                                          " missing places of joints were interpolated, over " +
                                          length_text({0, longest - 1}, tracks.fps) + " at most"});
  if (!dropped.empty())
    remarks.push_back(
        {"joints left out", "missing for more than a second, so not used: " + join(dropped, ", ")});
}

}  // namespace mocaplm
