#include "motion/import/limb_errors.h"

#include "common/text.h"

namespace mocaplm {

void LimbErrors::add(const std::string& clip, Eigen::Index frames, const RetargetReport& report) {
  ++schemes_[report.scheme];
  for (const LimbError& error : report.limbs) {
    Limb& limb = limbs_[error.limb];
    limb.sum += error.mean * static_cast<double>(frames);
    limb.frames += frames;
    // Ties go to the first name, so that threads cannot change the report.
    if (error.max > limb.max || (error.max == limb.max && clip < limb.worst_clip)) {
      limb.max = error.max;
      limb.worst_clip = clip;
      limb.worst_frame = error.worst_frame;
    }
  }
}

double LimbErrors::mean_degrees() const {
  double sum = 0;
  Eigen::Index frames = 0;
  for (const auto& [name, limb] : limbs_) {
    sum += limb.sum;
    frames += limb.frames;
  }
  return frames > 0 ? sum / static_cast<double>(frames) : 0;
}

Table LimbErrors::table() const {
  Table table("Limb directions after retargeting, degrees from the source's",
              {"limb", "mean", "largest", "in clip", "frame"});
  for (const auto& [name, limb] : limbs_)
    table.row({name, limb.sum / static_cast<double>(limb.frames), limb.max, limb.worst_clip,
               limb.worst_frame});
  std::vector<std::string> schemes;
  for (const auto& [scheme, clips] : schemes_)
    schemes.push_back(scheme + " (" + std::to_string(clips) + ")");
  table.note("Mean over all limbs and frames: " + format_fixed(mean_degrees(), 3) +
             ". Skeletons: " + join(schemes, ", ") + ".");
  return table;
}

}  // namespace mocaplm
