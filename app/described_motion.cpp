// mocaplm info FILE: a motion file.
#include <cmath>

#include "app/described_parts.h"
#include "common/text.h"
#include "motion/clip_range.h"
#include "motion/formats/aist.h"
#include "motion/formats/formats.h"
#include "motion/posture.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string label_text(const Labels& labels) {
  std::vector<std::string> parts;
  for (const auto& [label, value] : labels) parts.push_back(label + " " + value);
  return parts.empty() ? "none" : join(parts, ", ");
}

std::string vector_text(const Eigen::Vector3d& v) {
  std::vector<std::string> parts;
  for (int i = 0; i < 3; ++i)
    parts.push_back(format_fixed(std::abs(v[i]) < 0.005 ? 0 : v[i], 2));  // never -0.00
  return "(" + join(parts, ", ") + ")";
}

std::string degrees(double value) {
  return format_fixed(value, 0) + " degrees";
}

void add_way_rows(Table& table, const Clip& clip) {
  double way = 0;
  for (Eigen::Index t = 1; t < clip.frames(); ++t)
    way += std::hypot(clip.trans(t, 0) - clip.trans(t - 1, 0),
                      clip.trans(t, 2) - clip.trans(t - 1, 2));
  const Eigen::RowVector3d pelvis = rest_joints(clip).row(0);
  const Eigen::RowVector3d low = clip.trans.colwise().minCoeff() + pelvis;
  const Eigen::RowVector3d high = clip.trans.colwise().maxCoeff() + pelvis;
  table.row(
      {"pelvis height", format_fixed(low.y(), 2) + " to " + format_fixed(high.y(), 2) + " m"});
  table.row({"way of the pelvis over the floor", format_fixed(way, 2) + " m"});
}

// Vectors are those of the first frame, in metres; angles are means over all.
void add_posture_rows(Table& table, const BodyPosture& posture) {
  table.row({"hips to shoulders",
             vector_text(posture.trunk) + " m; " + degrees(posture.lean) + " from the vertical"});
  table.row({"hip line, right to left", vector_text(posture.hip_line) + " m; " +
                                            degrees(posture.twist) + " against the shoulders"});
  table.row({"shoulder line, right to left", vector_text(posture.shoulder_line) + " m"});
  table.row({"pelvis to head", vector_text(posture.head) + " m; face " +
                                   degrees(posture.head_turn) + " against the chest"});
  const char* const sides[] = {"left foot", "right foot"};
  for (std::size_t side = 0; side < 2; ++side)
    table.row({sides[side], vector_text(posture.feet[side]) + " m; " +
                                degrees(posture.feet_turn[side]) + " against the hips"});
  table.row({"height, sole to crown", format_fixed(posture.height, 2) + " m"});
  table.row({"lowest foot joint", format_fixed(posture.lowest_foot, 3) + " m"});
  table.row({"planted feet slide at", posture.slide ? format_fixed(*posture.slide, 1) + " cm/s"
                                                    : "no foot is planted long enough"});
}

void add_skeleton_rows(Table& table, const RetargetReport& report) {
  if (report.scheme.empty()) return;
  table.row({"skeleton", report.scheme});
  table.row({"unit", format_number(report.unit) + " m"});
  table.row({"rotations counted from", report.rest_pose});
  table.row({"path scaled by", format_fixed(report.path_scale, 3)});
  table.row({"its ankles to head, along the bones", format_fixed(report.height, 2) + " m"});
  table.row(
      {"limb directions off by", format_fixed(report.mean_degrees, 1) + " degrees on average"});
  if (!report.unmatched.empty())
    table.row({"SMPL joints without a source", join(report.unmatched, ", ")});
}

Table describe_one(const fs::path& path, const ReadMotion& motion, bool several) {
  const Clip& clip = motion.clip;
  Table table(several ? path.string() + ": " + clip.name : path.string(),
              {"motion file", lower(path.extension().string()).substr(1)});
  table.row({"frames", clip.frames()});
  table.row({"frames per second", clip.fps});
  table.row({"length", format_fixed(clip.seconds(), 2) + " s"});
  table.row(
      {"labels of its name", label_text(aist_labels(path.stem().string()).value_or(Labels{}))});
  add_way_rows(table, clip);
  const BodyPosture posture = measure_posture(clip);
  add_posture_rows(table, posture);
  add_skeleton_rows(table, motion.report.retarget);
  for (const Remark& remark : motion.report.remarks) table.note("Note: " + remark.text + ".");
  for (const Remark& remark : unlikely(posture, motion.report.retarget))
    table.note("Unlikely: " + remark.text + ".");
  return table;
}

}  // namespace

std::vector<Table> describe_motion(const fs::path& file, const ReadOptions& options,
                                   const ClipRange& range) {
  std::vector<ReadMotion> motions = read_clips(file, options);
  std::vector<Table> tables;
  for (ReadMotion& motion : motions) {
    motion.clip = cut(motion.clip, range).clip;
    tables.push_back(describe_one(file, motion, motions.size() > 1));
  }
  return tables;
}

}  // namespace mocaplm
