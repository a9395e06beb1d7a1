#include "emulator/motions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/error.h"
#include "common/files.h"
#include "common/parallel.h"
#include "common/settings.h"
#include "emulator/body.h"
#include "emulator/reduction.h"
#include "motion/chosen_clips.h"
#include "motion/resample.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr int kVersion = 1;

std::vector<PostureSequence> postures_of(const std::vector<Clip>& clips, const LandmarkTree& tree,
                                         const std::string& heading, int threads) {
  std::vector<PostureSequence> sequences(clips.size());
  parallel_for(clips.size(), threads, [&](std::size_t m) {
    if (clips[m].frames() < 2)
      throw DataError(in_file(clips[m].name),
                      "a clip of one frame is no motion; leave it out of the dataset");
    sequences[m] = clip_postures(clips[m], tree, heading);
  });
  return sequences;
}

Eigen::Index median_frames(const std::vector<Clip>& clips) {
  std::vector<Eigen::Index> frames;
  for (const Clip& clip : clips) frames.push_back(clip.frames());
  std::sort(frames.begin(), frames.end());
  return frames[frames.size() / 2];
}

}  // namespace

std::vector<PostureSequence> PreparedMotions::sequences() const {
  std::vector<PostureSequence> all;
  for (const Alignment& item : aligned.items) all.push_back(item.sequence);
  return all;
}

double PreparedMotions::mean_seconds() const {
  return std::accumulate(seconds.begin(), seconds.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(seconds.size(), 1));
}

PreparedMotions prepare_motions(const std::vector<Clip>& clips, const LandmarkOptions& landmarks,
                                const AlignOptions& align, int threads) {
  if (clips.empty()) throw DataError(in_file("motions"), "there are no clips to align");
  PreparedMotions prepared;
  prepared.landmarks = landmarks;
  prepared.align = align;
  prepared.tree = smpl_landmarks(parse_joints(landmarks.joints));
  const auto sequences = postures_of(clips, prepared.tree, landmarks.heading, threads);
  for (const Clip& clip : clips) {
    prepared.names.push_back(clip.name);
    // From the first frame to the last.
    prepared.seconds.push_back(static_cast<double>(clip.frames() - 1) / clip.fps);
  }
  const Eigen::Index frames = landmarks.frames > 0 ? landmarks.frames : median_frames(clips);
  prepared.aligned =
      align_all(sequences, frames, align, central_sequence(sequences, frames, threads), threads);
  // Each clip's turns about its limbs, read where its postures were.
  std::vector<Eigen::MatrixXd> turns(clips.size());
  parallel_for(clips.size(), threads, [&](std::size_t m) {
    turns[m] =
        turns_at(limb_turns(clips[m], prepared.tree),
                 prepared.aligned.items[m].warping * static_cast<double>(clips[m].frames() - 1));
  });
  prepared.turns = mean_turns(turns);
  return prepared;
}

std::vector<PostureSequence> prepare_like(const PreparedMotions& prepared,
                                          const std::vector<Clip>& clips, int threads) {
  auto sequences = postures_of(clips, prepared.tree, prepared.landmarks.heading, threads);
  parallel_for(sequences.size(), threads, [&](std::size_t m) {
    sequences[m] =
        align_to(sequences[m], prepared.aligned.fixed, prepared.aligned.reference, prepared.align)
            .sequence;
  });
  return sequences;
}

std::vector<Clip> sample_clips(const MotionEmulator& motions, std::size_t count, std::uint64_t seed,
                               bool timing, double fps) {
  const auto sequences = motions.emulator->sample(count, seed);
  Random random(stable_hash("timing", seed));
  std::vector<Clip> clips;
  for (std::size_t k = 0; k < count; ++k) {
    // The time of an example, or the mean time.
    const std::size_t example = random.below(motions.seconds.size());
    double seconds = 0;
    for (const double each : motions.seconds)
      seconds += each / static_cast<double>(motions.seconds.size());
    if (timing) seconds = motions.seconds[example];
    const auto frames =
        std::max<Eigen::Index>(2, static_cast<Eigen::Index>(std::lround(seconds * fps)) + 1);
    const double last = static_cast<double>(motions.emulator->frames() - 1);
    Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(frames, 0, last);
    if (timing) {
      // The warping says where in the example an aligned frame lay: it is turned round.
      const Eigen::VectorXd& warping = motions.warpings[example];
      Eigen::Index j = 0;
      for (Eigen::Index t = 0; t < frames; ++t) {
        const double at = static_cast<double>(t) / static_cast<double>(frames - 1);
        while (j + 2 < warping.size() && warping[j + 1] < at) ++j;
        times[t] = static_cast<double>(j) + (at - warping[j]) / (warping[j + 1] - warping[j]);
      }
      times = times.cwiseMax(0).cwiseMin(last);
    }
    clips.push_back(postures_clip(read_at(sequences[k], times), motions.tree,
                                  turns_at(motions.turns, times), fps,
                                  "emulated-" + std::to_string(k + 1)));
    for (const std::string& text : motions.where) clips.back().labels.insert(parse_where(text));
  }
  return clips;
}

MotionEmulator fit_motions(const PreparedMotions& prepared, const Scheme& scheme,
                           const SchemeOptions& options, int threads) {
  MotionEmulator motions;
  motions.landmarks = prepared.landmarks;
  motions.tree = prepared.tree;
  motions.align = prepared.align;
  motions.options = options;
  motions.seconds = prepared.seconds;
  for (const Alignment& item : prepared.aligned.items) motions.warpings.push_back(item.warping);
  motions.fixed = prepared.aligned.fixed;
  motions.reference = prepared.aligned.reference;
  motions.turns = prepared.turns;
  motions.emulator = fit_emulator(prepared.sequences(), scheme, options, threads);
  return motions;
}

void save_motion_emulator(const std::filesystem::path& path, const MotionEmulator& motions) {
  const Eigen::Index frames = motions.fixed.frames();
  Eigen::MatrixXd warpings(frames, static_cast<Eigen::Index>(motions.warpings.size()));
  for (std::size_t m = 0; m < motions.warpings.size(); ++m)
    warpings.col(static_cast<Eigen::Index>(m)) = motions.warpings[m];
  Json json = {{"format", "mocaplm emulator"},
               {"version", kVersion},
               {"data", motions.data},
               {"where", motions.where},
               {"procedural", motions.procedural},
               {"landmarks", settings_json(motions.landmarks)},
               {"align", settings_json(motions.align)},
               {"options", settings_json(motions.options)},
               {"seconds", motions.seconds},
               {"warpings", matrix_json(warpings)},
               {"template", matrix_json(motions.fixed.values)},
               {"reference", matrix_json(motions.reference)},
               {"turns", matrix_json(motions.turns)},
               {"emulator", motions.emulator->json()}};
  write_file(path, json.dump() + "\n");
}

MotionEmulator load_motion_emulator(const std::filesystem::path& path) {
  const Json json = load_json(path);
  JsonObject object(json, path.string());
  if (!object.has("format") || object.text("format") != "mocaplm emulator")
    throw DataError(in_file(path.string()), "is no emulator: expected a file of emulate fit");
  if (object.integer("version") != kVersion)
    object.fail("version", "this program reads version " + std::to_string(kVersion));
  MotionEmulator motions;
  motions.data = object.text("data");
  motions.where = object.texts("where");
  try {
    for (const std::string& text : motions.where) parse_where(text);
  } catch (const UsageError& error) {
    object.fail("where", error.what());
  }
  motions.procedural = object.boolean("procedural");
  const auto settings = [&](const char* key, auto& config) {
    JsonObject part = object.object(key);
    read_settings(config, part);
    part.finish();
  };
  settings("landmarks", motions.landmarks);
  settings("align", motions.align);
  settings("options", motions.options);
  try {
    motions.tree = smpl_landmarks(parse_joints(motions.landmarks.joints));
  } catch (const UsageError& error) {
    object.fail("landmarks", error.what());
  }
  motions.emulator = read_emulator(object.raw("emulator"), path.string() + ": \"emulator\"");
  const Eigen::Index limbs = motions.tree.limbs(), frames = motions.emulator->frames();
  if (motions.emulator->limbs() != limbs)
    object.fail("emulator", "is of " + std::to_string(motions.emulator->limbs()) +
                                " limbs, the landmarks have " + std::to_string(limbs));
  motions.seconds = object.numbers("seconds");
  if (motions.seconds.empty() ||
      *std::min_element(motions.seconds.begin(), motions.seconds.end()) <= 0)
    object.fail("seconds", "expected the clips' lengths, positive numbers");
  const Eigen::MatrixXd warpings =
      read_matrix(object, "warpings", frames, static_cast<Eigen::Index>(motions.seconds.size()));
  for (Eigen::Index m = 0; m < warpings.cols(); ++m) {
    motions.warpings.push_back(warpings.col(m));
    for (Eigen::Index t = 1; t < frames; ++t)
      if (warpings(t, m) <= warpings(t - 1, m))
        object.fail("warpings", "expected columns that only rise");
  }
  motions.fixed.values = read_matrix(object, "template", 3 * limbs, frames);
  check_sequence(motions.fixed, in_file(path.string() + ": \"template\""));
  motions.reference = read_matrix(object, "reference", 3, limbs);
  motions.turns = read_matrix(object, "turns", limbs + 1, frames);
  object.finish();
  return motions;
}

}  // namespace mocaplm
