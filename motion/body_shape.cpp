#include "motion/body_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/floor.h"
#include "motion/skeleton.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

using Eigen::Vector3d;

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// An ellipse about `centre`; `u`, `v` and the direction of the skin are a right-handed system.
BodyRing ellipse(const Vector3d& centre, const Vector3d& u, const Vector3d& v) {
  BodyRing ring;
  for (int i = 0; i < kRingPoints; ++i) {
    const double angle = kTurn * i / kRingPoints;
    ring.points[static_cast<std::size_t>(i)] = centre + std::cos(angle) * u + std::sin(angle) * v;
  }
  return ring;
}

// A limb is a chain of bones. Where it is how thick: `at` counts bones from the chain's beginning
// (1.5: the middle of the second one).
struct Girth {
  double at, width, depth;
};

// Along a chain of points; from point i on the limb follows joint owners[i + 1], before the first
// one owners[0].
struct LimbShape {
  std::vector<Vector3d> points;
  std::vector<int> owners;
  std::vector<Girth> girths;
  Vector3d across;  // roughly the direction of `width`
};

constexpr double kRingStep = 0.035;  // metres between the rings of a limb
constexpr double kBend = 0.055;      // metres on each side of a joint over which the skin bends

class LimbSkin {
 public:
  explicit LimbSkin(const LimbShape& limb) : limb_(limb) {
    arcs_ = {0};
    for (std::size_t i = 1; i < limb.points.size(); ++i)
      arcs_.push_back(arcs_.back() + (limb.points[i] - limb.points[i - 1]).norm());
  }

  BodySkin skin() const {
    const double from = arc(limb_.girths.front().at), to = arc(limb_.girths.back().at);
    const int rings = std::max(2, static_cast<int>(std::lround((to - from) / kRingStep)));
    BodySkin out;
    round_end(from, -1, out);
    for (int i = 0; i <= rings; ++i) out.push_back(ring(from + (to - from) * i / rings, 0, 1));
    round_end(to, 1, out);
    return out;
  }

 private:
  // Metres along the chain; beyond its end as the last bone goes on.
  double arc(double at) const {
    const auto bone = std::min(static_cast<std::size_t>(at), arcs_.size() - 2);
    return arcs_[bone] + (at - static_cast<double>(bone)) * (arcs_[bone + 1] - arcs_[bone]);
  }
  std::size_t bone_at(double arc) const {
    std::size_t bone = 0;
    while (bone + 2 < arcs_.size() && arc >= arcs_[bone + 1]) ++bone;
    return bone;
  }
  Vector3d direction(std::size_t bone) const {
    return (limb_.points[bone + 1] - limb_.points[bone]).normalized();
  }

  // Half width and depth, straight between the given ones.
  Eigen::Vector2d girth(double arc_length) const {
    const std::vector<Girth>& all = limb_.girths;
    std::size_t i = 1;
    while (i + 1 < all.size() && arc_length > arc(all[i].at)) ++i;
    const double from = arc(all[i - 1].at), to = arc(all[i].at);
    const double t = std::clamp((arc_length - from) / (to - from), 0.0, 1.0);
    return {(1 - t) * all[i - 1].width + t * all[i].width,
            (1 - t) * all[i - 1].depth + t * all[i].depth};
  }

  // A ring `out` metres beyond its place, shrunk by `scale`.
  BodyRing ring(double arc_length, double out, double scale) const {
    const std::size_t bone = bone_at(arc_length);
    const Vector3d way = direction(bone);
    const Vector3d centre = limb_.points[bone] + (arc_length - arcs_[bone] + out) * way;
    const Vector3d v = way.cross(limb_.across).normalized(), u = v.cross(way);
    const Eigen::Vector2d size = scale * girth(arc_length);
    BodyRing made = ellipse(centre, size[0] * u, size[1] * v);
    carry(arc_length, made);
    return made;
  }

  // Half a ball, `side` -1 at the beginning and 1 at the end.
  void round_end(double arc_length, int side, BodySkin& out) const {
    const double radius = girth(arc_length).minCoeff();
    for (const double degrees : {75.0, 50.0, 25.0}) {
      const double angle = (side < 0 ? degrees : 100 - degrees) * kPi / 180;
      out.push_back(ring(arc_length, side * radius * std::sin(angle), std::cos(angle)));
    }
  }

  // Follows the joint of its bone, near a joint more and more the next one's.
  void carry(double arc_length, BodyRing& ring) const {
    const std::size_t bone = bone_at(arc_length);
    ring.joints[0] = ring.joints[1] = limb_.owners[bone + 1];
    for (std::size_t i = bone; i <= bone + 1 && i + 1 < limb_.owners.size(); ++i) {
      const double off = (arc_length - arcs_[i]) / bend(i);
      if (std::abs(off) >= 1) continue;
      ring.joints[0] = limb_.owners[i];
      ring.joints[1] = limb_.owners[i + 1];
      ring.second = smooth_step((off + 1) / 2);
    }
  }

  // At most half of the bones beside the joint, so that no two bends overlap.
  double bend(std::size_t point) const {
    double metres = kBend;
    if (point > 0) metres = std::min(metres, (arcs_[point] - arcs_[point - 1]) / 2);
    if (point + 1 < arcs_.size()) metres = std::min(metres, (arcs_[point + 1] - arcs_[point]) / 2);
    return metres;
  }

  const LimbShape& limb_;
  std::vector<double> arcs_;  // of the points
};

// `side` 0 left, 1 right: every left joint is followed by the right one.
LimbShape leg(int side) {
  const int hip = 1 + side, knee = 4 + side, ankle = 7 + side;
  return {{rest_joint(hip), rest_joint(knee), rest_joint(ankle)},
          {0, hip, knee},
          {{0, .086, .088},
           {.2, .084, .086},
           {.55, .067, .07},
           {.9, .052, .055},
           {1.03, .0505, .0525},
           {1.3, .055, .058},
           {1.55, .045, .048},
           {1.85, .032, .034},
           {2.05, .031, .034}},
          Vector3d::UnitX()};
}

LimbShape arm(int side) {
  const int shoulder = 16 + side, elbow = 18 + side, wrist = 20 + side, hand = 22 + side;
  const Vector3d fingers = rest_joint(hand) + (rest_joint(hand) - rest_joint(wrist));
  return {{rest_joint(shoulder), rest_joint(elbow), rest_joint(wrist), rest_joint(hand), fingers},
          {13 + side, shoulder, elbow, wrist, hand},
          {{0, .056, .056},
           {.18, .055, .054},
           {.4, .047, .047},
           {.7, .041, .041},
           {1, .036, .036},
           {1.12, .039, .037},
           {1.3, .04, .038},
           {1.6, .034, .032},
           {2, .028, .022},
           {2.4, .034, .02},
           {2.9, .043, .018},
           {3.3, .041, .0155},
           {3.9, .03, .012}},
          Vector3d::UnitZ()};
}

// From the chest along the collar bone, and from the neck down to the shoulder.
LimbShape collar(int side) {
  return {{rest_joint(13 + side), rest_joint(16 + side)},
          {9, 13 + side},
          {{0, .052, .054}, {.5, .054, .056}, {1, .049, .049}},
          Vector3d::UnitZ()};
}
LimbShape trapezius(int side) {
  return {{rest_joint(12), rest_joint(16 + side)},
          {9, 13 + side},
          {{0, .048, .048}, {.35, .047, .045}, {.7, .047, .046}, {1, .045, .045}},
          Vector3d::UnitZ()};
}

LimbShape neck() {
  return {{rest_joint(12), rest_joint(15)},
          {9, 12, 15},
          {{-.35, .047, .047}, {.4, .047, .05}, {1, .048, .05}},
          Vector3d::UnitX()};
}

// A foot lies along a line between two points: share of the way, height above the line, half width,
// half height of its rings.
struct FootRing {
  double share, height, width, half_height;
};
constexpr FootRing kFootRings[] = {
    {-.24, .006, .004, .004}, {-.2, .005, .022, .022},  {-.08, .003, .032, .033},
    {.15, .012, .035, .043},  {.4, .009, .037, .041},   {.7, .002, .041, .034},
    {1, -.002, .043, .031},   {1.1, -.005, .034, .024}, {1.16, -.006, .004, .004}};
constexpr FootRing kToeRings[] = {{-.25, -.004, .034, .025}, {.1, -.004, .044, .0295},
                                  {.6, -.003, .042, .025},   {1, -.002, .034, .02},
                                  {1.2, -.004, .022, .014},  {1.28, -.005, .003, .003}};

// One of figure_soles(), of the left ones, and on the right the one after it.
Vector3d sole(std::size_t left, int side) {
  const Sole& found = figure_soles()[left + static_cast<std::size_t>(side)];
  return rest_joint(found.joint) + found.middle.transpose();
}
Vector3d heel(int side) {
  return sole(0, side);
}
Vector3d toe_tip(int side) {
  return sole(4, side);
}

template <std::size_t Size>
BodySkin foot_part(const FootRing (&rings)[Size], int side, bool toes) {
  const int ankle = 7 + side, ball = 10 + side;
  const Vector3d start = toes ? rest_joint(ball) : heel(side);
  const Vector3d way = (toes ? toe_tip(side) : rest_joint(ball)) - start;
  const Vector3d across = (rest_joint(ankle) - heel(side)).cross(way).normalized();
  const Vector3d up = way.cross(across).normalized();
  BodySkin skin;
  for (const FootRing& r : rings) {
    skin.push_back(
        ellipse(start + r.share * way + r.height * up, r.width * across, r.half_height * up));
    skin.back().joints[0] = ankle;
    skin.back().joints[1] = ball;
    skin.back().second = toes ? 1 : smooth_step((r.share - .5) / .6);
  }
  return skin;
}

// The trunk's rings: where the middle lies between joints, half width and depth, and who carries
// it.
struct TrunkRing {
  std::vector<std::pair<int, double>> middle;
  double width, depth;
  int owner;
};

const std::vector<TrunkRing>& trunk_rings() {
  static const std::vector<TrunkRing> rings = {
      {{{1, .93}, {2, .93}, {0, -.86}}, .02, .02, 0},
      {{{1, .85}, {2, .85}, {0, -.7}}, .1, .086, 0},
      {{{1, .62}, {2, .62}, {0, -.24}}, .153, .112, 0},
      {{{1, .25}, {2, .25}, {0, .5}}, .164, .121, 0},
      {{{0, .5}, {3, .5}}, .148, .11, 0},
      {{{3, .6}, {6, .4}}, .134, .101, 3},
      {{{6, .45}, {9, .3}, {13, .125}, {14, .125}}, .15, .111, 6},
      {{{9, .45}, {13, .275}, {14, .275}}, .163, .112, 9},
      {{{9, .1}, {13, .45}, {14, .45}}, .156, .104, 9},
      {{{12, .3}, {13, .35}, {14, .35}}, .132, .09, 9},
      {{{12, .78}, {13, .11}, {14, .11}}, .082, .066, 9},
      {{{12, .88}, {15, .12}}, .047, .047, 12}};
  return rings;
}

// A value of the smooth (Catmull-Rom) curve through values 0 .. count - 1, as weights of four
// neighbours.
std::array<std::pair<std::size_t, double>, 4> curve_weights(std::size_t count, double at) {
  const std::size_t k = std::min(static_cast<std::size_t>(at), count - 2);
  const double t = at - static_cast<double>(k), t2 = t * t, t3 = t2 * t;
  return {{{k == 0 ? 0 : k - 1, (-t + 2 * t2 - t3) / 2},
           {k, (2 - 5 * t2 + 3 * t3) / 2},
           {k + 1, (t + 4 * t2 - 3 * t3) / 2},
           {std::min(k + 2, count - 1), (t3 - t2) / 2}}};
}

BodySkin trunk() {
  constexpr int kParts = 2;  // rings for each ring of the table
  const std::vector<TrunkRing>& keys = trunk_rings();
  BodySkin skin;
  for (std::size_t i = 0; i <= kParts * (keys.size() - 1); ++i) {
    const double at = static_cast<double>(i) / kParts;
    Vector3d middle = Vector3d::Zero();
    double width = 0, depth = 0;
    for (const auto& [key, weight] : curve_weights(keys.size(), at)) {
      for (const auto& [joint, share] : keys[key].middle)
        middle += weight * share * rest_joint(joint);
      width += weight * keys[key].width;
      depth += weight * keys[key].depth;
    }
    skin.push_back(ellipse(middle, depth * Vector3d::UnitZ(), width * Vector3d::UnitX()));
    const std::size_t below = std::min(i / kParts, keys.size() - 2);
    skin.back().joints[0] = keys[below].owner;
    skin.back().joints[1] = keys[below + 1].owner;
    skin.back().second = smooth_step(at - static_cast<double>(below));
  }
  return skin;
}

// An egg with chin and nose.
BodySkin head() {
  constexpr int kRings = 14;
  BodySkin skin;
  for (int i = 1; i < kRings; ++i) {
    const double up = kPi * (static_cast<double>(i) / kRings - 0.5);
    const double y = std::sin(up), low = std::max(-y, 0.0);
    BodyRing ring;
    ring.joints[0] = ring.joints[1] = 15;
    for (int k = 0; k < kRingPoints; ++k) {
      const double turn = kTurn * k / kRingPoints;
      const double x = std::cos(up) * std::sin(turn), z = std::cos(up) * std::cos(turn);
      const double front = std::max(z, 0.0);
      const double nose = .018 * std::exp(-(x * x * 34 + (y + .18) * (y + .18) * 22)) * front;
      ring.points[static_cast<std::size_t>(k)] =
          rest_joint(15) + Vector3d(.077 * x * (1 - .22 * low * low),
                                    .085 + .118 * y - .01 * low * front,
                                    .014 + .098 * z * (1 - .22 * low) + .022 * low + nose);
    }
    skin.push_back(ring);
  }
  return skin;
}

}  // namespace

std::vector<BodySkin> body_skins() {
  std::vector<BodySkin> skins = {trunk(), LimbSkin(neck()).skin(), head()};
  for (const int side : {0, 1}) {
    for (const LimbShape& limb : {leg(side), arm(side), collar(side), trapezius(side)})
      skins.push_back(LimbSkin(limb).skin());
    skins.push_back(foot_part(kFootRings, side, false));
    skins.push_back(foot_part(kToeRings, side, true));
  }
  return skins;
}

}  // namespace mocaplm
