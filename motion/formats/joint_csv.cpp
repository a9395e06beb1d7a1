#include "motion/formats/joint_csv.h"

#include "common/files.h"
#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr int kDigits = 6;

void append_cell(std::string& text, double value) {
  append_fixed(text += ',', value, kDigits);
}

}  // namespace

std::string joint_csv(const Clip& clip) {
  std::string text = "frame,time";
  for (const std::string& joint : joint_names())
    for (const char* axis : {"_x", "_y", "_z"}) text += "," + joint + axis;
  text += '\n';
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    text += std::to_string(t);
    append_cell(text, static_cast<double>(t) / clip.fps);
    const JointPositions joints = joint_positions(clip, t);
    for (Eigen::Index i = 0; i < joints.size(); ++i) append_cell(text, joints.data()[i]);
    text += '\n';
  }
  return text;
}

void write_joint_csv(const std::filesystem::path& path, const Clip& clip) {
  check_clip(clip, path.string());
  write_file(path, joint_csv(clip));
}

}  // namespace mocaplm
