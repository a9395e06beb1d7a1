#include "motion/formats/phalp.h"

#include <algorithm>
#include <map>

#include "common/text.h"
#include "motion/formats/smpl_arrays.h"

namespace mocaplm {

namespace {

// What one frame says of one person.
struct PersonFrame {
  std::size_t frame = 0;
  Eigen::Matrix<double, 1, 72> pose;
  Eigen::RowVector3d trans;
  std::vector<double> betas;
};
using Tracks = std::map<std::string, std::vector<PersonFrame>>;

std::string number_text(const NumpyArray& array, std::size_t i) {
  return format_number(array.at(i, 0));
}

void add_phalp_frame(const ArrayDict& frame, std::size_t index, Tracks& tracks) {
  const auto people = frame.dict("smpl"), cameras = frame.dict("camera");
  const auto ids = frame.dict("tid");
  if (!people || !ids) return;
  for (const std::string& i : people->keys()) {
    const auto smpl = people->dict(i);
    if (!smpl || !ids->has(i)) continue;
    PersonFrame row;
    row.frame = index;
    row.pose.setZero();
    const RotationVectors root = read_rotations(*smpl, "global_orient", {1}),
                          body = read_rotations(*smpl, "body_pose", {21, 23});
    row.pose.head<3>() = root.row(0);
    row.pose.segment(3, body.cols()) = body.row(0);
    row.trans = cameras && cameras->has(i)
                    ? Eigen::RowVector3d(read_translations(*cameras, i).row(0))
                    : Eigen::RowVector3d::Zero();
    bool differ = false;
    if (smpl->has("betas")) row.betas = read_betas(*smpl, "betas", differ);
    const NumpyArray id = ids->array(i);
    tracks[number_text(id, 0)].push_back(std::move(row));
  }
}

void add_romp_frame(const ArrayDict& frame, std::size_t index, Tracks& tracks) {
  const RotationVectors poses = read_rotations(frame, "smpl_thetas", {24});
  const Translations trans = frame.has("cam_trans") ? read_translations(frame, "cam_trans")
                                                    : Translations::Zero(poses.rows(), 3);
  const auto people = static_cast<std::size_t>(poses.rows());
  NumpyArray ids;
  const bool tracked = frame.has("track_ids") && (ids = frame.array("track_ids")).rows() == people;
  for (std::size_t p = 0; p < people && trans.rows() == poses.rows(); ++p) {
    PersonFrame row;
    row.frame = index;
    row.pose = poses.row(static_cast<Eigen::Index>(p));
    row.trans = trans.row(static_cast<Eigen::Index>(p));
    bool differ = false;
    if (frame.has("smpl_betas") && people == 1) row.betas = read_betas(frame, "smpl_betas", differ);
    tracks[tracked ? number_text(ids, p) : std::to_string(p)].push_back(std::move(row));
  }
}

SmplRecord record_of(const std::vector<PersonFrame>& rows, const std::string& program) {
  SmplRecord record;
  record.program = program;
  record.usual_fps = kVideoFps;
  record.up = UpAxis::minus_y;
  record.layout = UpLayout::usual;
  record.poses.resize(static_cast<Eigen::Index>(rows.size()), 72);
  record.trans.resize(record.poses.rows(), 3);
  std::size_t gaps = 0;
  bool differ = false;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    record.poses.row(static_cast<Eigen::Index>(t)) = rows[t].pose;
    record.trans.row(static_cast<Eigen::Index>(t)) = rows[t].trans;
    gaps += t > 0 && rows[t].frame > rows[t - 1].frame + 1;
    differ = differ || rows[t].betas != rows[0].betas;
  }
  // The mean of the frames that have a shape.
  std::vector<double> sum(rows[0].betas.size(), 0.0);
  double count = 0;
  for (const PersonFrame& row : rows) {
    if (row.betas.size() != sum.size()) continue;
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += row.betas[b];
    ++count;
  }
  for (double& beta : sum) beta /= count;
  record.body.betas = differ ? sum : rows[0].betas;
  if (differ)
    record.remarks.push_back(
        {"changing shape", "betas change from frame to frame: their mean is taken"});
  if (gaps > 0)
    record.remarks.push_back(
        {"frames left out", "leaves out frames of its video in " + std::to_string(gaps) +
                                (gaps == 1 ? " place" : " places") + ": the motion jumps there"});
  return record;
}

}  // namespace

std::vector<TrackedPerson> read_frames_of_people(const ArrayDict& dict) {
  std::vector<TrackedPerson> people;
  const auto results = dict.dict("results");
  const ArrayDict& frames = results ? *results : dict;
  std::vector<std::string> names = frames.keys();
  if (names.empty()) return people;
  const auto first = frames.dict(names.front());
  if (!first) return people;
  const bool phalp = first->has("tid") && first->has("smpl"), romp = first->has("smpl_thetas");
  if (!phalp && !romp) return people;
  std::sort(names.begin(), names.end());
  Tracks tracks;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto frame = frames.dict(names[i]);
    if (!frame) continue;
    if (phalp)
      add_phalp_frame(*frame, i, tracks);
    else if (frame->has("smpl_thetas"))
      add_romp_frame(*frame, i, tracks);
  }
  for (const auto& [id, list] : tracks)
    people.push_back({id, record_of(list, phalp ? "4D-Humans" : "ROMP")});
  return people;
}

}  // namespace mocaplm
