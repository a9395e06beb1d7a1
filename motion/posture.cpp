#include "motion/posture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "motion/floor.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "motion/smpl_joints.h"
#include "motion/vectors.h"

namespace mocaplm {

namespace {

constexpr double kContact = 0.03;   // metres above the lowest soles within which a foot may stand
constexpr double kStep = 1.0 / 30;  // seconds over which a speed is taken
// The crown of the figure that this program draws, from the head joint.
const Eigen::Vector3d kCrown(0, 0.203, 0);

// The joints up to the shoulders, which all below is made of.
constexpr std::size_t kLooked = 18;
constexpr std::array<std::size_t, kLooked> kBody = {0, 1,  2,  3,  4,  5,  6,  7,  8,
                                                    9, 10, 11, 12, 13, 14, 15, 16, 17};
constexpr std::array<std::size_t, 9> kLegs = {0, 1, 2, 4, 5, 7, 8, 10, 11};

struct Figure {
  std::array<Eigen::Matrix3d, kLooked> rotations;
  std::array<Eigen::Vector3d, kLooked> positions;

  Eigen::Vector3d bone(std::size_t from, std::size_t to) const {
    return positions[to] - positions[from];
  }
};

// `joints`: each after its parent.
template <std::size_t n>
void pose(const Clip& clip, Eigen::Index frame, const RestJoints& rest,
          const std::array<std::size_t, n>& joints, Figure& figure) {
  for (const std::size_t j : joints) {
    const auto row = static_cast<Eigen::Index>(j);
    const Eigen::Matrix3d local =
        matrix_from_axis_angle(clip.poses.row(frame).segment<3>(3 * row).transpose());
    if (j == 0) {
      figure.rotations[0] = local;
      figure.positions[0] = (rest.row(0) + clip.trans.row(frame)).transpose();
      continue;
    }
    const auto parent = static_cast<std::size_t>(joint_parents()[j]);
    figure.rotations[j] = figure.rotations[parent] * local;
    figure.positions[j] =
        figure.positions[parent] +
        figure.rotations[parent] *
            (rest.row(row) - rest.row(static_cast<Eigen::Index>(parent))).transpose();
  }
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return angle_between(a, b) * kDegrees;
}

// Degrees between what of both lies across `axis`.
double angle_around(const Eigen::Vector3d& axis, const Eigen::Vector3d& a,
                    const Eigen::Vector3d& b) {
  const Eigen::Vector3d n = axis.normalized();
  return degrees_between(a - a.dot(n) * n, b - b.dot(n) * n);
}

// A point of a sole and its height: the one of a foot (0: left) that is lowest.
struct SolePoint {
  const Sole* sole = nullptr;
  double height = 0;
};

Eigen::Vector3d position(const Sole& sole, const Figure& figure) {
  const auto joint = static_cast<std::size_t>(sole.joint);
  return figure.positions[joint] + figure.rotations[joint] * sole.middle.transpose();
}

SolePoint lowest_point(const Figure& figure, std::size_t side) {
  SolePoint lowest;
  for (std::size_t i = side; i < figure_soles().size(); i += 2) {
    const Sole& sole = figure_soles()[i];
    const double height = position(sole, figure).y() - sole.radius;
    if (lowest.sole == nullptr || height < lowest.height) lowest = {&sole, height};
  }
  return lowest;
}

// How fast the lowest point of a foot goes over the floor, and how high it is at its higher end.
struct Contact {
  double height, speed;
};

double share_at(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class Measure {
 public:
  Measure(const Clip& clip, Eigen::Index most) : clip_(clip), rest_(rest_joints(clip)) {
    const Eigen::Index frames = clip.frames(), n = most > 0 ? std::min(most, frames) : frames;
    step_ = std::max<Eigen::Index>(1, std::llround(clip.fps * kStep));
    for (Eigen::Index i = 0; i < n; ++i) look(n > 1 ? i * (frames - 1) / (n - 1) : 0);
    finish(static_cast<double>(n));
  }

  const BodyPosture& posture() const { return out_; }

 private:
  void look(Eigen::Index frame) {
    pose(clip_, frame, rest_, kBody, now_);
    const Eigen::Vector3d trunk =
        now_.bone(kLeftHip, kLeftShoulder) + now_.bone(kRightHip, kRightShoulder);
    const Eigen::Vector3d hips = now_.bone(kRightHip, kLeftHip),
                          shoulders = now_.bone(kRightShoulder, kLeftShoulder);
    if (frame == 0) {
      out_.trunk = 0.5 * trunk;
      out_.hip_line = hips;
      out_.shoulder_line = shoulders;
      out_.head = now_.bone(kPelvis, kHead);
      out_.feet = {now_.bone(kLeftAnkle, kLeftFoot), now_.bone(kLeftAnkle + 1, kRightFoot)};
    }
    add_trunk(trunk, hips, shoulders);
    for (std::size_t side = 0; side < 2; ++side) add_leg(side, hips);
    add_heights();
    add_steps(frame);
  }

  void add_trunk(const Eigen::Vector3d& trunk, const Eigen::Vector3d& hips,
                 const Eigen::Vector3d& shoulders) {
    const double lean = degrees_between(trunk, Eigen::Vector3d::UnitY());
    const double twist = angle_around(trunk, hips, shoulders);
    const Eigen::Matrix3d& turned = now_.rotations[kHead];
    const double head_turn = angle_around(trunk, turned.col(2), shoulders.cross(trunk));
    out_.lean += lean;
    out_.twist += twist;
    out_.head_turn += head_turn;
    out_.lying += lean > 60;
    out_.upside_down += lean > 120;
    out_.hips_across += twist > 60;
    out_.shoulders_folded += shoulders.norm() < 0.7 * (rest_.row(16) - rest_.row(17)).norm();
    const bool head_down = degrees_between(turned.col(1), trunk) > 120;
    out_.head_down += head_down;
    out_.head_backwards += head_turn > 110 && !head_down;
  }

  void add_leg(std::size_t side, const Eigen::Vector3d& hips) {
    const Eigen::Vector3d thigh = now_.bone(kLeftHip + side, kLeftKnee + side),
                          shin = now_.bone(kLeftKnee + side, kLeftAnkle + side),
                          foot = now_.bone(kLeftAnkle + side, kLeftFoot + side);
    // Of a foot whose sole is not below it, as that of a runner's leg behind, the floor says
    // nothing.
    const Eigen::Matrix3d& ankle = now_.rotations[kLeftAnkle + side];
    const Eigen::Vector3d flat(foot.x(), 0, foot.z()),
        facing = hips.cross(Eigen::Vector3d::UnitY());
    if (ankle(1, 1) > 0.5 && facing.norm() > 0.5 * hips.norm()) {
      const double turn = degrees_between(flat, facing);
      out_.feet_turn[side] += turn;
      out_.feet_backwards[side] += turn > 110;
      ++feet_[side];
    }
    // The trace of a rotation is 1 + 2 cos(angle); cos(100 degrees) is -0.1736.
    const double trace = now_.rotations[kLeftKnee + side].cwiseProduct(ankle).sum();
    out_.ankles_turned[side] += trace < 1 + 2 * -0.1736;
    // Knee and ankle bend about opposite axes: the toes point to where the knee does.
    out_.knees_backwards[side] +=
        degrees_between(thigh, shin) > 20 && thigh.cross(shin).dot(shin.cross(foot)) > 0;
  }

  void add_heights() {
    const double crown = (now_.positions[kHead] + now_.rotations[kHead] * kCrown).y();
    for (std::size_t side = 0; side < 2; ++side) soles_[side] = lowest_point(now_, side);
    const double sole = std::min(soles_[0].height, soles_[1].height);
    out_.height = std::max(out_.height, crown - sole);
    lowest_soles_.push_back(sole);
    feet_heights_.push_back(
        std::min(now_.positions[kLeftFoot].y(), now_.positions[kRightFoot].y()));
  }

  void add_steps(Eigen::Index frame) {
    const Eigen::Index other = frame + step_ < clip_.frames() ? frame + step_ : frame - step_;
    if (other < 0) return;
    const double seconds = static_cast<double>(step_) / clip_.fps;
    pose(clip_, other, rest_, kLegs, then_);
    std::array<Contact, 2> contacts;
    for (std::size_t side = 0; side < 2; ++side) {
      const Sole& sole = *soles_[side].sole;
      const Eigen::Vector3d moved = position(sole, then_) - position(sole, now_);
      contacts[side] = {soles_[side].height + std::max(0.0, moved.y()),
                        100 * std::hypot(moved.x(), moved.z()) / seconds};
    }
    steps_.push_back(contacts);
    const Eigen::Vector3d moved = then_.positions[kPelvis] - now_.positions[kPelvis];
    out_.travel += 100 * std::hypot(moved.x(), moved.z()) / seconds;
  }

  void finish(double n) {
    for (double* sum :
         {&out_.lean, &out_.twist, &out_.head_turn, &out_.lying, &out_.upside_down,
          &out_.hips_across, &out_.shoulders_folded, &out_.head_backwards, &out_.head_down})
      *sum /= n;
    for (std::size_t side = 0; side < 2; ++side) {
      out_.feet_turn[side] /= std::max(1, feet_[side]);
      out_.feet_backwards[side] /= n;
      out_.ankles_turned[side] /= n;
      out_.knees_backwards[side] /= n;
    }
    out_.lowest_foot = *std::min_element(feet_heights_.begin(), feet_heights_.end());
    out_.usual_foot = share_at(feet_heights_, 0.05);
    if (steps_.empty()) return;
    out_.travel /= static_cast<double>(steps_.size());
    const double floor = share_at(lowest_soles_, 0.05);
    std::vector<double> speeds;
    for (const std::array<Contact, 2>& feet : steps_) {
      double slower = -1;
      for (const Contact& foot : feet)
        if (foot.height < floor + kContact && (slower < 0 || foot.speed < slower))
          slower = foot.speed;
      if (slower >= 0) speeds.push_back(slower);
    }
    if (speeds.size() >= 8) out_.slide = share_at(speeds, 0.25);
  }

  const Clip& clip_;
  const RestJoints& rest_;
  Eigen::Index step_ = 1;
  Figure now_, then_;
  std::array<SolePoint, 2> soles_;
  std::array<int, 2> feet_{};
  std::vector<double> lowest_soles_, feet_heights_;
  std::vector<std::array<Contact, 2>> steps_;
  BodyPosture out_;
};

}  // namespace

BodyPosture measure_posture(const Clip& clip, Eigen::Index most) {
  return Measure(clip, most).posture();
}

}  // namespace mocaplm
