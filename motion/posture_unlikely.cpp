// What is called out of a motion, and from where on. A share of half the frames leaves room for a
// dancer who lies down, turns over or crosses the legs; faults of a conversion last.
#include <algorithm>

#include "common/text.h"
#include "motion/floor.h"
#include "motion/posture.h"

namespace mocaplm {

namespace {

constexpr double kMostFrames = 0.5;           // of the frames
constexpr double kUnder = 0.05;               // metres a sole may lie under the floor
constexpr double kOver = 0.20;                // and the lower foot over it
constexpr double kSlide = 30;                 // cm/s, and
constexpr double kSlideShare = 0.35;          // of the pelvis's speed: feet of a sprint roll
constexpr double kSmall = 0.7, kLarge = 2.5;  // metres along the bones from ankles to head

std::string percent(double share) {
  return format_fixed(100 * share, 0) + " % of the frames";
}

std::string centimetres(double metres) {
  return format_fixed(100 * metres, 0) + " cm";
}

void add_heights(const BodyPosture& posture, std::vector<Remark>& found) {
  const double sole = posture.usual_foot - kSoleBelowFoot;
  if (sole < -kUnder)
    found.push_back({"feet under the floor", "the soles are " + centimetres(-sole) +
                                                 " under height 0 (--align-floor at import or "
                                                 "convert --floor puts them there)"});
  if (sole > kOver)
    found.push_back({"feet over the floor",
                     "the soles stay " + centimetres(sole) +
                         " over height 0 (--align-floor at import or convert --floor puts them "
                         "there)"});
}

void add_directions(const BodyPosture& posture, std::vector<Remark>& found) {
  if (posture.upside_down > kMostFrames)
    found.push_back({"trunk upside down", "the trunk is upside down in " +
                                              percent(posture.upside_down) +
                                              ": another axis may point up (--up)"});
  else if (posture.lying > kMostFrames)
    found.push_back({"trunk lying", "the trunk lies, leaning by " + format_fixed(posture.lean, 0) +
                                        " degrees on average: another axis may point up (--up)"});
  if (posture.hips_across > kMostFrames)
    found.push_back({"hips across the shoulders", "the hips are turned against the shoulders by " +
                                                      format_fixed(posture.twist, 0) +
                                                      " degrees on average"});
  if (posture.shoulders_folded > kMostFrames)
    found.push_back({"shoulders folded in", "the shoulders are folded in, " +
                                                centimetres(posture.shoulder_line.norm()) +
                                                " apart in the first frame"});
  if (posture.head_down > 0.1)
    found.push_back(
        {"head upside down", "the head is upside down in " + percent(posture.head_down)});
  if (posture.head_backwards > 0.2)
    found.push_back(
        {"head backwards", "the face points backwards in " + percent(posture.head_backwards)});
  const char* const sides[] = {"left", "right"};
  for (std::size_t side = 0; side < 2; ++side) {
    if (posture.feet_backwards[side] > kMostFrames)
      found.push_back({"feet backwards", std::string("the ") + sides[side] +
                                             " foot points backwards in " +
                                             percent(posture.feet_backwards[side])});
    if (posture.ankles_turned[side] > 0.02)
      found.push_back({"ankles turned over", std::string("the ") + sides[side] +
                                                 " foot is turned over against the shin in " +
                                                 percent(posture.ankles_turned[side])});
    if (posture.knees_backwards[side] > 0.25)
      found.push_back({"knees backwards", std::string("the ") + sides[side] +
                                              " knee bends backwards in " +
                                              percent(posture.knees_backwards[side])});
  }
}

}  // namespace

std::vector<Remark> unlikely(const BodyPosture& posture, const RetargetReport& report) {
  std::vector<Remark> found;
  if (report.height > 0 && (report.height < kSmall || report.height > kLarge))
    found.push_back({report.height < kSmall ? "small figure" : "large figure",
                     "the figure measures " + centimetres(report.height) +
                         " from the ankles to the head at " + format_number(report.unit) +
                         " m a unit: another unit may be right (--unit)"});
  add_heights(posture, found);
  if (posture.slide && *posture.slide > std::max(kSlide, kSlideShare * posture.travel))
    found.push_back({"feet slide", "planted feet slide at " + format_fixed(*posture.slide, 0) +
                                       " cm/s, the pelvis goes at " +
                                       format_fixed(posture.travel, 0) + " cm/s"});
  add_directions(posture, found);
  return found;
}

}  // namespace mocaplm
