#include "infill/infill.h"

#include <algorithm>
#include <cmath>

#include "common/angles.h"
#include "common/error.h"
#include "common/progress.h"
#include "common/text.h"
#include "model/directory.h"
#include "model/transformer/setup.h"
#include "model/transformer/weights.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "tokenizer/conditions.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

namespace {

// Which frames and channels are missing.
struct Gap {
  Eigen::Index first, last;
  std::vector<int> joints;
  std::vector<bool> channels;  // of the tokenizer
  bool whole_frames;           // every joint and the root
};

Gap make_gap(const InfillOptions& options, const Tokenizer& tokenizer, Eigen::Index frames) {
  const double fps = tokenizer.config().fps;
  const auto frame = [&](double seconds) {
    return static_cast<Eigen::Index>(std::llround(std::min(seconds * fps, 1e9)));
  };
  Gap gap{std::min(frame(options.from), frames),
          options.to > 0 ? std::min(frame(options.to), frames) : frames, options.joints,
          std::vector<bool>(static_cast<std::size_t>(tokenizer.channels()), options.joints.empty()),
          options.joints.empty()};
  if (gap.first >= gap.last)
    throw UsageError("nothing is missing: at " + format_number(fps) +
                     " frames per second the clip has " + std::to_string(frames) +
                     " frames, --from and --to leave none of them");
  if (gap.whole_frames && gap.last - gap.first == frames)
    throw UsageError("nothing of the clip is known: give --joints, --from and --to, or both");
  if (gap.whole_frames) gap.joints = tokenizer.joints();
  for (const int joint : gap.joints) {
    const auto& known = tokenizer.joints();
    const auto found = std::find(known.begin(), known.end(), joint);
    if (found == known.end())
      throw UsageError("--joints: the model does not tell " +
                       joint_names()[static_cast<std::size_t>(joint)]);
    for (int axis = 0; axis < 3; ++axis)
      gap.channels[static_cast<std::size_t>(3 * (found - known.begin()) + axis)] = true;
  }
  if (!gap.whole_frames && gap.last - gap.first == frames &&
      std::find(gap.channels.begin(), gap.channels.end(), false) == gap.channels.end())
    throw UsageError("nothing of the clip is known: leave some joints or frames");
  return gap;
}

std::vector<std::int32_t> hidden(std::vector<std::int32_t> ids, const Gap& gap) {
  const std::size_t per_frame = gap.channels.size() + 1;
  for (Eigen::Index t = gap.first; t < gap.last; ++t)
    for (std::size_t c = 0; c < gap.channels.size(); ++c)
      if (gap.channels[c]) ids[static_cast<std::size_t>(t) * per_frame + c] = Tokenizer::kMask;
  return ids;
}

// The path that `told` takes through the gap, from where the clip is to where it goes on.
void fit_path(Clip& filled, const Clip& told, const Clip& original, const Gap& gap) {
  const bool begins = gap.first > 0, ends = gap.last < original.frames();
  const Eigen::Index from = begins ? gap.first - 1 : gap.last;  // a known frame
  const Eigen::RowVector3d start = original.trans.row(from) - told.trans.row(from);
  Eigen::RowVector3d bend = Eigen::RowVector3d::Zero();
  if (begins && ends) bend = original.trans.row(gap.last) - told.trans.row(gap.last) - start;
  for (Eigen::Index t = gap.first; t < gap.last; ++t) {
    const double share =
        static_cast<double>(t - gap.first + 1) / static_cast<double>(gap.last - gap.first + 1);
    filled.trans.row(t) = told.trans.row(t) + start + share * bend;
  }
}

Clip assembled(const Clip& original, const Clip& told, const Gap& gap, bool tells_root) {
  Clip filled = gap.whole_frames ? bridged(original, gap.first, gap.last) : original;
  for (Eigen::Index t = gap.first; t < gap.last; ++t)
    for (const int joint : gap.joints)
      filled.poses.row(t).segment<3>(3 * joint) = told.poses.row(t).segment<3>(3 * joint);
  if (gap.whole_frames && tells_root) fit_path(filled, told, original, gap);
  filled.name = original.name + " (filled)";
  return filled;
}

void check_labels(const InfillOptions& options, const ModelDescription& model,
                  const Tokenizer& tokenizer) {
  for (const auto& [name, value] : options.labels) {
    if (std::find(model.conditions.begin(), model.conditions.end(), name) == model.conditions.end())
      throw UsageError("the model knows no condition \"" + name + "\"" +
                       known_names(name, model.conditions, "It knows"));
    tokenizer.label_id(name, value);
  }
}

}  // namespace

Clip bridged(const Clip& clip, Eigen::Index first, Eigen::Index last) {
  Clip out = clip;
  const Eigen::Index before = first > 0 ? first - 1 : last,
                     after = last < clip.frames() ? last : first - 1;
  for (Eigen::Index t = first; t < last; ++t) {
    const double share =
        before == after ? 0 : static_cast<double>(t - before) / static_cast<double>(after - before);
    for (int j = 0; j < kJoints; ++j) {
      const auto rotation = [&](Eigen::Index frame) {
        return quaternion_from_axis_angle(clip.poses.row(frame).segment<3>(3 * j).transpose());
      };
      out.poses.row(t).segment<3>(3 * j) =
          axis_angle_from_quaternion(rotation(before).slerp(share, rotation(after))).transpose();
    }
    out.trans.row(t) = (1 - share) * clip.trans.row(before) + share * clip.trans.row(after);
  }
  return out;
}

FillError fill_error(const Clip& a, const Clip& b, const std::vector<int>& joints,
                     Eigen::Index first, Eigen::Index last) {
  FillError error;
  for (Eigen::Index t = first; t < last; ++t)
    for (const int joint : joints) {
      const auto rotation = [&](const Clip& clip) {
        return quaternion_from_axis_angle(clip.poses.row(t).segment<3>(3 * joint).transpose());
      };
      const double angle = kDegrees * geodesic_angle(rotation(a), rotation(b));
      error.mean += angle;
      error.most = std::max(error.most, angle);
    }
  error.mean /= static_cast<double>(
      std::max<std::size_t>(static_cast<std::size_t>(last - first) * joints.size(), 1));
  return error;
}

InfillResult infill(const InfillOptions& options) {
  set_up_cpu(options.threads);
  const std::string place = resolve_model(options.model).string();
  const StoredModel stored = load_model(options.model);
  const ModelDescription& d = stored.description;
  if (!d.masked())
    throw UsageError(place + " is no masked model: train one with --objective masked");
  const Tokenizer tokenizer = Tokenizer::of_model(stored.tokenizer, d.tokenizer_fingerprint, place);
  check_labels(options, d, tokenizer);

  InfillResult result;
  result.procedural = d.procedural;
  result.original = tokenizer.at_rate(options.clip);
  const Gap gap = make_gap(options, tokenizer, result.original.frames());
  const std::vector<std::int32_t> ids = tokenizer.encode(result.original).ids;
  const std::vector<std::int32_t> asked = hidden(ids, gap);
  result.tokens = std::count(asked.begin(), asked.end(), Tokenizer::kMask);

  const auto model = load_transformer(stored, place);
  const at::Device device = choose_device(options.device);
  model->to(device);
  model->set_precision(choose_precision(options.precision, device));
  std::vector<int> channel_bins;
  for (int c = 0; c < tokenizer.channels(); ++c) channel_bins.push_back(tokenizer.channel_bins(c));
  Progress bar("infill", static_cast<std::size_t>(options.fill.rounds), "rounds");
  const std::vector<std::int32_t> filled =
      fill_hidden(*model, condition_prefix(tokenizer, d.conditions, options.labels), asked,
                  Tokenizer::kMask, channel_bins, options.fill,
                  [&](std::int64_t round) { bar.update(static_cast<std::size_t>(round)); });
  bar.finish();

  const Eigen::Vector3d start = result.original.trans.row(0).transpose();
  const bool tells_root = tokenizer.config().root != "none";
  result.joints = gap.joints;
  result.first = gap.first;
  result.last = gap.last;
  result.filled =
      assembled(result.original, tokenizer.decode(filled, "filled", start), gap, tells_root);
  const auto error = [&](const Clip& clip) {
    return fill_error(clip, result.original, gap.joints, gap.first, gap.last);
  };
  result.error = error(result.filled);
  result.bins = error(tokenizer.decode(ids, "clip", start));
  if (gap.first > 0 || gap.last < result.original.frames())
    result.line = error(bridged(result.original, gap.first, gap.last));
  return result;
}

}  // namespace mocaplm
