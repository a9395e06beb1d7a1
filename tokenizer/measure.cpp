#include "tokenizer/measure.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/text.h"
#include "motion/resample.h"
#include "motion/rotation.h"

namespace mocaplm {

namespace {

void add(double value, double& sum, double& max) {
  sum += value;
  max = std::max(max, value);
}

void measure_rotations(const Tokenizer& tokenizer, const Tokenizer::Rotations& values,
                       const Clip& decoded, TokenizerLoss& loss) {
  for (Eigen::Index t = 0; t < values.rows(); ++t) {
    const double* frame = decoded.poses.row(t).data();
    for (int c = 0; c < tokenizer.rotation_channels(); c += 3) {
      const Eigen::Vector3d before = values.row(t).segment<3>(c).transpose();
      const Eigen::Vector3d after(frame + 3 * tokenizer.channel_joint(c));
      for (int axis = 0; axis < 3; ++axis)
        add(kDegrees * std::abs(before[axis] - after[axis]), loss.component_sum,
            loss.component_max);
      add(kDegrees *
              geodesic_angle(quaternion_from_axis_angle(before), quaternion_from_axis_angle(after)),
          loss.rotation_sum, loss.rotation_max);
    }
  }
  loss.components += values.rows() * tokenizer.rotation_channels();
  loss.rotations += values.rows() * tokenizer.rotation_channels() / 3;
}

}  // namespace

TokenStream encode_and_measure(const Tokenizer& tokenizer, const Clip& given, TokenizerLoss& loss) {
  Clip resampled;
  const Clip& clip = tokenizer.at_rate(given, resampled);
  const TokenStream stream = tokenizer.encode(clip, &loss.encoded);
  const Clip decoded = tokenizer.decode(stream.ids, clip.name, clip.trans.row(0).transpose());
  measure_rotations(tokenizer, tokenizer.rotation_values(clip), decoded, loss);
  if (tokenizer.config().root != "none")
    for (Eigen::Index t = 0; t < clip.frames(); ++t)
      add(100 * (clip.trans.row(t) - decoded.trans.row(t)).norm(), loss.root_sum, loss.root_max);
  ++loss.clips;
  loss.frames += clip.frames();
  loss.tokens += static_cast<std::int64_t>(stream.size());
  return stream;
}

Table TokenizerLoss::table(const Tokenizer& tokenizer) const {
  const auto mean = [](double sum, std::int64_t count) {
    return count > 0 ? sum / static_cast<double>(count) : 0;
  };
  Table table("Tokenizer: " + std::to_string(tokenizer.bins()) + " " + tokenizer.config().binning +
                  " bins, " + std::to_string(tokenizer.channels()) + " channels, " +
                  format_number(tokenizer.config().fps) + " frames per second",
              {"quantity", "value", "unit"});
  table.row({"clips", clips, ""});
  table.row({"frames", frames, ""});
  table.row({"tokens", tokens, "with separators"});
  table.row({"clamped values", encoded.clamped, "outside the bins"});
  table.row(
      {"clamped share", 100 * mean(static_cast<double>(encoded.clamped), encoded.values), "%"});
  table.row(
      {"farthest outside, rotations", kDegrees * encoded.farthest_rotation, "degrees a component"});
  if (tokenizer.config().root != "none")
    table.row({"farthest outside, root", 100 * encoded.farthest_root, "cm"});
  table.row({"component error, mean", mean(component_sum, components), "degrees"});
  table.row({"component error, max", component_max, "degrees"});
  table.row({"rotation error, mean", mean(rotation_sum, rotations), "degrees, geodesic"});
  table.row({"rotation error, max", rotation_max, "degrees, geodesic"});
  if (tokenizer.config().root != "none") {
    table.row({"root error, mean", mean(root_sum, frames), "cm"});
    table.row({"root error, max", root_max, "cm"});
  }
  int fewest = tokenizer.bins(), short_of = 0;
  for (int c = 0; c < tokenizer.channels(); ++c) {
    fewest = std::min(fewest, tokenizer.channel_bins(c));
    short_of += tokenizer.channel_bins(c) < tokenizer.bins();
  }
  if (short_of > 0)
    table.note(std::to_string(short_of) + " channels have fewer bins (" + std::to_string(fewest) +
               " the fewest): the clips hold no more different values of them");
  table.note("fingerprint " + tokenizer.fingerprint());
  return table;
}

}  // namespace mocaplm
