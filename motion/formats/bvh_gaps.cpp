#include "motion/formats/bvh_gaps.h"

#include <cmath>
#include <functional>

#include "common/angles.h"
#include "common/error.h"
#include "common/text.h"
#include "motion/rotation.h"

namespace mocaplm {

namespace {

using Index = Eigen::Index;

constexpr double kLongest = 1;  // second

// The frames [first, last) that lack a value, and the share of the way from the one before to the
// one after that each has gone.
struct LineGap {
  Index first, last;
  double share(Index frame) const {
    return static_cast<double>(frame - first + 1) / static_cast<double>(last - first + 1);
  }
};

class Filler {
 public:
  Filler(Bvh& bvh, double fps, const std::string& file) : bvh_(bvh), fps_(fps), file_(file) {}

  void run() {
    for (const BvhJoint& joint : bvh_.joints) {
      std::vector<Index> turns;
      for (std::size_t c = 0; c < joint.channels.size(); ++c) {
        const Index column = joint.first_channel + static_cast<int>(c);
        if (static_cast<int>(joint.channels[c]) < 3)
          fill_line(joint, column, false);
        else
          turns.push_back(column);
      }
      if (turns.size() == 3)
        fill_rotation(joint, turns);
      else
        for (const Index column : turns) fill_line(joint, column, true);
    }
  }

 private:
  // Calls `fill` for every run of frames in which one of the columns lacks its value.
  void each_gap(const BvhJoint& joint, const std::vector<Index>& columns,
                const std::function<void(const LineGap&)>& fill) const {
    const auto lacks = [&](Index t) {
      for (const Index column : columns)
        if (!std::isfinite(bvh_.values(t, column))) return true;
      return false;
    };
    std::vector<LineGap> gaps;
    for (Index t = 0; t < bvh_.frames(); ++t) {
      if (!lacks(t)) continue;
      const Index first = t;
      while (t < bvh_.frames() && lacks(t)) ++t;
      gaps.push_back({first, t});
    }
    for (const LineGap& gap : gaps) check(joint, gap);
    for (const LineGap& gap : gaps) fill(gap);
  }

  void check(const BvhJoint& joint, const LineGap& gap) const {
    const double seconds = static_cast<double>(gap.last - gap.first) / fps_;
    const bool never = gap.first == 0 && gap.last == bvh_.frames();
    if (!never && seconds <= kLongest + 1e-9) return;
    throw DataError(at_joint(file_, static_cast<std::size_t>(gap.first), joint.name),
                    never ? std::string("has no number in any frame")
                          : "has no number up to frame " + std::to_string(gap.last - 1) + ", for " +
                                format_fixed(seconds, 2) +
                                " s; gaps of up to one second are filled: cut the motion there");
  }

  void fill_line(const BvhJoint& joint, Index column, bool angle) {
    auto values = bvh_.values.col(column);
    each_gap(joint, {column}, [&](const LineGap& gap) {
      const double before = values(gap.first > 0 ? gap.first - 1 : gap.last);
      double way = values(gap.last < bvh_.frames() ? gap.last : gap.first - 1) - before;
      if (angle) way = std::remainder(way, 360);
      for (Index t = gap.first; t < gap.last; ++t) values(t) = before + gap.share(t) * way;
    });
  }

  void fill_rotation(const BvhJoint& joint, const std::vector<Index>& columns) {
    const EulerOrder order = {axis(joint, columns[0]), axis(joint, columns[1]),
                              axis(joint, columns[2])};
    const auto rotation = [&](Index t) {
      Eigen::Vector3d angles;
      for (int i = 0; i < 3; ++i)
        angles[i] = kRadians * bvh_.values(t, columns[static_cast<std::size_t>(i)]);
      return quaternion_from_matrix(matrix_from_euler(angles, order));
    };
    each_gap(joint, columns, [&](const LineGap& gap) {
      const Eigen::Quaterniond before = rotation(gap.first > 0 ? gap.first - 1 : gap.last);
      const Eigen::Quaterniond after =
          rotation(gap.last < bvh_.frames() ? gap.last : gap.first - 1);
      for (Index t = gap.first; t < gap.last; ++t) {
        const Eigen::Vector3d angles =
            euler_from_matrix(before.slerp(gap.share(t), after).toRotationMatrix(), order);
        for (int i = 0; i < 3; ++i)
          bvh_.values(t, columns[static_cast<std::size_t>(i)]) = angles[i] / kRadians;
      }
    });
  }
  static int axis(const BvhJoint& joint, Index column) {
    return static_cast<int>(
               joint.channels[static_cast<std::size_t>(column - joint.first_channel)]) -
           3;
  }

  Bvh& bvh_;
  double fps_;
  const std::string& file_;
};

}  // namespace

bool is_gap(std::string_view word) {
  std::string text = lower(std::string(word.substr(0, 20)));
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.erase(0, 1);
  for (const char* begin : {"nan", "inf", "1.#"})
    if (text.compare(0, 3, begin) == 0) return true;
  return text == "null" || text == "none" || text == "undefined";
}

void fill_gaps(Bvh& bvh, double fps, const std::string& file) {
  Filler(bvh, fps, file).run();
}

}  // namespace mocaplm
