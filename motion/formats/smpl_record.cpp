#include "motion/formats/smpl_record.h"

#include <cmath>

#include "common/text.h"
#include "motion/formats/smpl_arrays.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

const std::vector<std::size_t> kWhole = {22, 24, 52, 55};  // SMPL's body, SMPL, SMPL+H, SMPL-X

std::string first_of(const ArrayDict& dict, const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    if (dict.has(key)) return key;
  return "";
}

// The body's rotations of a whole pose: all of SMPL's 24, 22 of the others, whose hands follow.
void set_poses(const RotationVectors& all, SmplRecord& record) {
  const Eigen::Index columns = all.cols() == 72 ? 72 : 66;
  record.poses = Poses::Zero(all.rows(), 72);
  record.poses.leftCols(columns) = all.leftCols(columns);
}

void set_trans(const ArrayDict& dict, const std::string& key, SmplRecord& record) {
  if (key.empty()) {
    record.trans = Translations::Zero(record.poses.rows(), 3);
    record.remarks.push_back({"no translation",
                              "has no translation of the root: the pelvis stays in "
                              "its place"});
    return;
  }
  record.trans = read_translations(dict, key);
  if (record.trans.rows() != record.poses.rows())
    throw DataError(dict.place(key), key + " has the shape " + shape_text(dict.array(key)) +
                                         ", but there are " + std::to_string(record.poses.rows()) +
                                         " frames of poses");
}

// EDGE's figure has its root at smpl_trans itself, and full_pose (N, 24, 3) are its joints. Whether
// those lie as SMPL's do instead.
bool pelvis_is_beside(const ArrayDict& dict, const Eigen::RowVector3d& trans) {
  if (!dict.has("full_pose")) return false;
  const NumpyArray joints = dict.array("full_pose");
  if (joints.dimensions() != 3 || joints.shape[1] != 24 || joints.shape[2] != 3 ||
      joints.type.kind != 'f' || joints.column_major || joints.shape[0] == 0)
    return false;
  NumpyArray rows = joints;
  rows.shape = {joints.shape[0] * 24, 3};
  const Eigen::RowVector3d pelvis(rows.at(0, 0), rows.at(0, 1), rows.at(0, 2));
  return (pelvis - trans - rest_joints().row(0)).norm() < 0.05;
}

std::optional<SmplRecord> aist_or_edge(const ArrayDict& dict) {
  if (!dict.has("smpl_poses")) return std::nullopt;
  SmplRecord record;
  set_poses(read_rotations(dict, "smpl_poses", {22, 24}), record);
  if (!dict.has("smpl_trans"))
    throw DataError(
        in_file(dict.file()),
        "has no smpl_trans: it holds " + dict.contents() +
            ", expected an AIST++ motion file with smpl_poses, smpl_scaling and smpl_trans");
  set_trans(dict, "smpl_trans", record);
  if (dict.has("smpl_scaling")) {
    record.program = "AIST++";
    const Place place = dict.place("smpl_scaling");
    const double scaling = single_number(dict.array("smpl_scaling"), "smpl_scaling", place);
    if (!(scaling > 1e-6 && scaling < 1e9))
      throw DataError(place, "smpl_scaling is " + format_number(scaling) +
                                 ", expected a positive number of about 93");
    record.trans /= scaling;
    record.usual_fps = 60;
    record.up = UpAxis::y;
    record.layout = UpLayout::usual;
    return record;
  }
  record.program = "EDGE";
  record.usual_fps = 30;
  record.up = UpAxis::z;
  record.layout = UpLayout::usual;
  record.trans_is_pelvis = !pelvis_is_beside(dict, record.trans.row(0));
  return record;
}

std::optional<SmplRecord> wham_world(const ArrayDict& dict) {
  if (!dict.has("pose_world")) return std::nullopt;
  SmplRecord record;
  record.program = "WHAM";
  set_poses(read_rotations(dict, "pose_world", kWhole), record);
  set_trans(dict, first_of(dict, {"trans_world"}), record);
  record.usual_fps = kVideoFps;
  record.up = UpAxis::y;
  record.layout = UpLayout::usual;
  return record;
}

// Root and body apart, `body` also with the hands' two joints of SMPL.
void set_parts(const ArrayDict& dict, const std::string& root_key, const std::string& body_key,
               SmplRecord& record) {
  const RotationVectors root = read_rotations(dict, root_key, {1});
  const RotationVectors body = read_rotations(dict, body_key, {21, 23, 51, 54});
  if (root.rows() != body.rows())
    throw DataError(dict.place(body_key), body_key + " has " + std::to_string(body.rows()) +
                                              " frames, but " + root_key + " " +
                                              std::to_string(root.rows()));
  const Eigen::Index columns = body.cols() == 69 ? 69 : 63;
  record.poses = Poses::Zero(root.rows(), 72);
  record.poses.leftCols(3) = root;
  record.poses.middleCols(3, columns) = body.leftCols(columns);
}

std::optional<SmplRecord> root_and_body(const ArrayDict& dict) {
  const bool amass = dict.has("root_orient") && dict.has("pose_body");
  const std::string root = first_of(dict, {"root_orient", "global_orient", "smpl_global_orient",
                                           "pred_global_orient", "smplx_root_pose"});
  const std::string body = first_of(
      dict, {"pose_body", "body_pose", "smpl_body_pose", "pred_body_pose", "smplx_body_pose"});
  if (root.empty() || body.empty() || (!amass && dict.has("poses") && dict.has("trans")))
    return std::nullopt;
  if (amass && dict.has("poses")) return std::nullopt;
  SmplRecord record;
  set_parts(dict, root, body, record);
  set_trans(dict,
            first_of(dict, {"transl", "trans", "translation", "smpl_transl", "pred_trans",
                            "root_trans", "pred_cam_t", "cam_trans", "smplx_transl"}),
            record);
  if (amass) {
    record.program = "AMASS";
    record.up = UpAxis::z;
    record.layout = UpLayout::usual;
  } else {
    record.program = "GVHMR, DART, 4D-Humans and their kin";
    record.usual_fps = kVideoFps;
  }
  return record;
}

bool amass_marks(const ArrayDict& dict) {
  return !first_of(dict, {"surface_model_type", "markers_latent", "marker_data", "mocap_markers",
                          "mocap_framerate", "dmpls"})
              .empty();
}

RestJoints read_rest(const ArrayDict& dict) {
  const NumpyArray array = dict.array("rest_joints");
  const Place place = dict.place("rest_joints");
  check_motion_array(array, "rest_joints", 3, place);
  if (array.rows() != 24)
    throw DataError(place, "rest_joints has the shape " + shape_text(array) + ", expected (24, 3)");
  RestJoints rest;
  copy_columns(array, 0, 3, rest);
  if (!(rest.cwiseAbs().maxCoeff() < 10))
    throw DataError(place, "rest_joints lie more than 10 metres away");
  return rest;
}

std::optional<SmplRecord> amass(const ArrayDict& dict) {
  if (!dict.has("poses")) return std::nullopt;
  SmplRecord record;
  record.program = "AMASS";
  const RotationVectors poses = read_rotations(dict, "poses", kWhole);
  set_poses(poses, record);
  if (!dict.has("trans") && !dict.has("transl"))
    throw DataError(in_file(dict.file()),
                    "has no trans (root translation), only " + dict.contents());
  set_trans(dict, first_of(dict, {"trans", "transl"}), record);
  // This program says what it wrote.
  if (const auto up = dict.text("up_axis"); up && *up == "y") {
    record.up = UpAxis::y;
    record.layout = UpLayout::fixed;
    if (dict.has("rest_joints")) record.body.rest = read_rest(dict);
    return record;
  }
  switch (poses.cols()) {
    case 72:
      record.up = UpAxis::y;
      record.layout = UpLayout::usual;
      break;
    case 156:
      record.up = UpAxis::z;
      record.layout = UpLayout::usual;
      break;
    case 165:  // SMPL-X of AMASS has Z up, that of EMAGE and BEAT2 Y up
      record.up = UpAxis::z;
      record.layout = amass_marks(dict) ? UpLayout::usual : UpLayout::unknown;
      break;
    default:
      break;
  }
  return record;
}

std::optional<SmplRecord> in_camera(const ArrayDict& dict) {
  const std::string key =
      first_of(dict, {"pred_rotmat", "pose", "pred_pose", "smpl_thetas", "thetas"});
  if (key.empty()) return std::nullopt;
  SmplRecord record;
  record.program = key == "pred_rotmat" ? "TRAM" : "WHAM or VIBE, in the camera's space";
  set_poses(read_rotations(dict, key, kWhole), record);
  set_trans(dict, first_of(dict, {"pred_trans", "trans", "transl", "cam_trans", "pred_cam_t"}),
            record);
  record.usual_fps = kVideoFps;
  record.up = UpAxis::minus_y;
  record.layout = UpLayout::usual;
  return record;
}

void read_body(const ArrayDict& dict, SmplRecord& record) {
  bool differ = false;
  const std::string key =
      first_of(dict, {"betas", "shape", "pred_shape", "pred_betas", "smpl_betas"});
  if (!key.empty()) record.body.betas = read_betas(dict, key, differ);
  if (differ)
    record.remarks.push_back(
        {"changing shape", key + " changes from frame to frame: its mean is taken"});
  if (const auto gender = dict.text("gender")) record.body.gender = lower(*gender).substr(0, 20);
}

// Frames of a video in which nobody was found are left out of these files.
void check_gaps(const ArrayDict& dict, SmplRecord& record) {
  const std::string key = first_of(dict, {"frame_ids", "frame", "frames"});
  if (key.empty() || dict.dict(key) || dict.text(key)) return;
  const NumpyArray ids = dict.array(key);
  if (ids.dimensions() != 1 || !ids.type.is_number() ||
      ids.rows() != static_cast<std::size_t>(record.poses.rows()))
    return;
  std::size_t gaps = 0;
  for (std::size_t t = 1; t < ids.rows(); ++t) gaps += ids.at(t, 0) != ids.at(t - 1, 0) + 1;
  if (gaps > 0)
    record.remarks.push_back(
        {"frames left out", "leaves out frames of its video in " + std::to_string(gaps) +
                                (gaps == 1 ? " place" : " places") + ": the motion jumps there"});
}

}  // namespace

std::optional<double> frame_rate(const ArrayDict& dict) {
  for (const char* key :
       {"mocap_framerate", "mocap_frame_rate", "fps", "frame_rate", "framerate"}) {
    if (!dict.has(key)) continue;
    const double rate = single_number(dict.array(key), key, dict.place(key));
    const double whole = std::round(rate);
    // AMASS has rates such as 120.00004577636719.
    return whole > 0 && std::abs(rate - whole) < 1e-3 ? whole : rate;
  }
  return std::nullopt;
}

std::optional<SmplRecord> read_smpl_record(const ArrayDict& dict) {
  for (const auto& scheme : {aist_or_edge, wham_world, root_and_body, amass, in_camera}) {
    std::optional<SmplRecord> record = scheme(dict);
    if (!record) continue;
    record->fps = frame_rate(dict);
    read_body(dict, *record);
    check_gaps(dict, *record);
    return record;
  }
  return std::nullopt;
}

std::string positions_key(const ArrayDict& dict) {
  for (const char* key : {"joints", "positions", "keypoints3d", "joints3d", "joints_3d",
                          "joint_positions", "full_pose", "motion"}) {
    if (!dict.has(key) || dict.dict(key)) continue;
    const NumpyArray array = dict.array(key);
    const std::size_t d = array.dimensions();
    if (array.type.kind == 'f' && d >= 2 && (array.shape[d - 1] == 3 || array.shape[d - 2] == 3))
      return key;
  }
  return "";
}

std::string other_content(const ArrayDict& dict) {
  if (dict.has("betas") && !dict.has("expression") && dict.keys().size() <= 4)
    return "a body's shape without motion (AMASS's shape.npz): leave it out";
  if (!first_of(dict, {"expression", "expressions", "jaw_pose"}).empty())
    return "SMPL-X's face without the body";
  if (!first_of(dict, {"v_template", "J_regressor"}).empty())
    return "a body model, not a motion: give it with --body FILE";
  if (!first_of(dict, {"verts", "vertices"}).empty())
    return "vertices of a mesh without SMPL's rotations";
  if (!first_of(dict, {"state_dict", "model_state_dict", "optimizer"}).empty())
    return "a network's weights, not a motion";
  return "";
}

}  // namespace mocaplm
