#include "motion/formats/position_table.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/joint_vocabulary.h"
#include "motion/formats/position_gaps.h"
#include "motion/ik/fit.h"

namespace mocaplm {

namespace {

constexpr double kLargest = 1e7;  // ten kilometres in millimetres
// Metres from hip to ankle that a person, child or giant of a game, has.
constexpr double kShortestLeg = 0.4, kLongestLeg = 1.3;

std::string first_names(std::vector<std::string> names) {
  const std::size_t all = names.size();
  if (all > 12) names.resize(12);
  return join(names, ", ") + (all > 12 ? " and " + std::to_string(all - 12) + " more" : "");
}

PointNames points_of(const PositionTable& table) {
  PointNames points = find_points(table.names);
  if (points.missing.empty()) return points;
  if (are_skin_markers(table.names))
    throw DataError(in_file(table.file),
                    "holds markers on the skin (" + first_names(table.names) +
                        "), not joints: solve them to joint centres or to a skeleton first, in the "
                        "program that recorded them");
  throw DataError(in_file(table.file), "gives no " + join(points.missing, ", ") + " among " +
                                           first_names(table.names) +
                                           "; hips, knees, ankles, shoulders, elbows and wrists "
                                           "of both sides are needed");
}

PointTracks tracks_of(const PositionTable& table, const PointNames& points) {
  PointTracks tracks;
  tracks.fps = *table.fps;
  tracks.places.setConstant(table.places.rows(), 3 * kPoints, std::nan(""));
  for (int point = 0; point < kPoints; ++point) {
    const int name = points.index[static_cast<std::size_t>(point)];
    if (name < 0) continue;
    tracks.given[static_cast<std::size_t>(point)] = true;
    tracks.places.middleCols<3>(3 * point) = table.places.middleCols(3 * name, 3);
  }
  // Some programs write 0 0 0 for what they did not find. A root may well be there.
  for (int point = 1; point < kPoints; ++point) {
    Eigen::Index zeros = 0;
    const auto is_zero = [&](Eigen::Index t) { return tracks.at(t, point).isZero(0); };
    for (Eigen::Index t = 0; t < tracks.frames(); ++t) zeros += is_zero(t) ? 1 : 0;
    for (Eigen::Index t = 0; t < tracks.frames() && zeros > 0; ++t)
      if (is_zero(t)) tracks.places.row(t).segment<3>(3 * point).setConstant(std::nan(""));
  }
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    for (int point = 0; point < kPoints; ++point)
      if (tracks.at(t, point).cwiseAbs().maxCoeff() > kLargest)
        throw DataError(at_joint(table.file, static_cast<std::size_t>(t), point_name(point)),
                        "lies absurdly far away, more than 1e7 from the origin");
  return tracks;
}

// The lowest of all joints at y = 0 and the first pelvis above the origin, both by a twentieth of
// the legs.
bool stands_as_human_ml3d(const PointTracks& tracks) {
  double lowest = HUGE_VAL;
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    for (int point = 0; point < kPoints; ++point)
      if (tracks.given[static_cast<std::size_t>(point)])
        lowest = std::min(lowest, tracks.at(t, point).y());
  const Eigen::Vector3d pelvis = tracks.at(0, 0);
  const double near = 0.05 * measure_body(tracks).leg();
  return std::abs(lowest) < near && std::hypot(pelvis.x(), pelvis.z()) < near;
}

void turn_up(PointTracks& tracks, const PositionTable& table, const ReadOptions& options,
             std::vector<Remark>& remarks) {
  const FoundUp found = find_up(tracks);
  UpAxis up = options.up;
  if (up == UpAxis::automatic && table.y_up) {
    up = UpAxis::y;
    if (found.sure() && found.axis != up)
      remarks.push_back({"up axis",
                         "Y is taken as up, as the format has it, but the body points "
                         "along " +
                             to_string(found.axis) + ": --up says otherwise"});
  } else if (up == UpAxis::automatic && table.by_custom_y_up &&
             (!found.sure() || (found.axis != UpAxis::y && stands_as_human_ml3d(tracks)))) {
    up = UpAxis::y;
    remarks.push_back({"up axis",
                       "Y is taken as up, as HumanML3D has it; the body does not stand "
                       "along it: --up says otherwise"});
  } else if (up == UpAxis::automatic) {
    if (!found.sure())
      throw DataError(in_file(table.file),
                      "does not show which way is up: nobody stands upright for most of it; say "
                      "--up y or another of x, y, z, -x, -y, -z");
    up = found.axis;
    remarks.push_back({"up axis", to_string(up) + " is up, by the body's direction"});
  }
  if (up == UpAxis::y) return;
  const Eigen::Matrix3d turn = turn_to_y_up(up);
  for (Eigen::Index t = 0; t < tracks.frames(); ++t)
    for (int point = 0; point < kPoints; ++point)
      if (tracks.given[static_cast<std::size_t>(point)])
        tracks.places.row(t).segment<3>(3 * point) = (turn * tracks.at(t, point)).transpose();
}

// Metres per unit of the file.
double find_unit(double leg, const PositionTable& table, const ReadOptions& options,
                 std::vector<Remark>& remarks) {
  if (options.unit) return *options.unit;
  const auto fits = [&](double unit) {
    return leg * unit >= kShortestLeg && leg * unit <= kLongestLeg;
  };
  const std::string measured =
      "the legs measure " + format_number(std::round(leg * 1000) / 1000) + " from hip to ankle";
  if (table.unit && fits(*table.unit)) return *table.unit;
  const std::string but =
      table.unit ? ", though the file says " + format_number(*table.unit) + " m" : "";
  const std::pair<double, const char*> units[] = {
      {1, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}};
  for (const auto& [unit, name] : units)
    if (fits(unit)) {
      remarks.push_back(
          {"unit", std::string("lengths are taken as ") + name + ", since " + measured + but});
      return unit;
    }
  const double unit = smpl_measure().leg() / leg;
  remarks.push_back({"unit", "a unit of " + format_number(unit) + " m is taken, since " + measured +
                                 but + ": no common unit makes that a person"});
  return unit;
}

std::string at_worst(const Residual& residual) {
  return format_fixed(residual.worst, 2) + " cm at worst (" + point_name(residual.worst_point) +
         ", frame " + std::to_string(residual.worst_frame) + ")";
}

Remark residual_remark(const PositionFit& fit) {
  return {"residual",
          "joints of the figure lie " + format_fixed(fit.from_source.root_mean_square, 2) +
              " cm (root mean square) from the file's, " + at_worst(fit.from_source) +
              ", after scaling by " + format_number(std::round(fit.scale * 1e4) / 1e4) +
              "; with SMPL's bone lengths " + format_fixed(fit.from_bones.root_mean_square, 2) +
              " cm, " + at_worst(fit.from_bones)};
}

}  // namespace

ReadMotion motion_from_positions(PositionTable table, const std::string& name,
                                 const ReadOptions& options) {
  const PointNames points = points_of(table);
  if (options.fps) table.fps = options.fps;
  if (!table.fps)
    throw DataError(in_file(table.file),
                    "says no frame rate: tell it (import, view: --fps; convert, render: "
                    "--source-fps)");
  if (!(*table.fps >= 1e-6 && *table.fps <= 10000))
    throw DataError(in_file(table.file), "has a rate of " + format_number(*table.fps) +
                                             " frames per second, expected more than 0 and at "
                                             "most 10000");
  ReadMotion motion;
  std::vector<Remark>& remarks = motion.report.remarks;
  remarks = std::move(table.remarks);
  PointTracks tracks = tracks_of(table, points);
  table.places.resize(0, 0);
  close_gaps(tracks, options.fill_gaps, table.file, remarks);
  const BodyMeasure body = measure_body(tracks);
  check_body(body, table.file);
  check_handedness(tracks, table.file);
  turn_up(tracks, table, options, remarks);
  const double unit = find_unit(body.leg(), table, options, remarks);
  PositionFit fit = fit_positions(tracks, unit, options.keep_path);
  if (!points.left_out.empty())
    remarks.push_back({"joints left out", "not used: " + first_names(points.left_out)});
  // The file's own scale, in metres.
  fit.scale /= unit;
  remarks.push_back(residual_remark(fit));
  motion.clip = std::move(fit.clip);
  motion.clip.name = name;
  return motion;
}

}  // namespace mocaplm
