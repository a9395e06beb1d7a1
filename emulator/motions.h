// From clips of a dataset to aligned sequences, and from sampled sequences to clips.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "emulator/align.h"
#include "emulator/emulator.h"
#include "emulator/landmarks.h"
#include "motion/clip.h"

namespace mocaplm {

struct LandmarkOptions {
  std::vector<std::string> joints = {"all"};
  std::string heading = "start";
  std::int64_t frames = 0;
  template <class Visitor>
  void describe(Visitor& v) {
    v.texts("joints", joints, "landmarks: joints or groups of them");
    v.choice(
        "heading", heading, heading_names(),
        "whose heading is taken away: nothing's, the first frame's, the mean one, every frame's");
    v.integer("frames", frames, 0, 100000, "frames of an aligned sequence; 0: the clips' median");
  }
};

// What was made of clips before a scheme is fitted.
struct PreparedMotions {
  LandmarkTree tree;
  LandmarkOptions landmarks;
  AlignOptions align;
  std::vector<std::string> names;
  std::vector<double> seconds;  // each clip's length
  Aligned aligned;              // of T frames each
  Eigen::MatrixXd turns;        // (n, T): mean limb_turns (emulator/body.h) at each aligned frame

  std::vector<PostureSequence> sequences() const;
  double mean_seconds() const;
};

// Landmarks, then alignment to the central clip or the mean. Throws DataError naming a clip of one
// frame, or for no clips.
PreparedMotions prepare_motions(const std::vector<Clip>& clips, const LandmarkOptions& landmarks,
                                const AlignOptions& align, int threads = 0);
// Other clips, aligned to the template of these: for held-out clips.
std::vector<PostureSequence> prepare_like(const PreparedMotions& prepared,
                                          const std::vector<Clip>& clips, int threads = 0);

// What `emulate fit` keeps: a file, JSON, {"format": "mocaplm emulator", "version": 1, ...}.
struct MotionEmulator {
  LandmarkOptions landmarks;
  LandmarkTree tree;
  AlignOptions align;
  SchemeOptions options;
  std::vector<std::string> where;  // the class
  std::string data;                // the dataset it was fitted to
  bool procedural = false;
  std::vector<double> seconds;            // of the clips fitted to
  std::vector<Eigen::VectorXd> warpings;  // (T) of each, as Alignment's
  PostureSequence fixed;                  // the template
  Posture reference;                      // of the template's field
  Eigen::MatrixXd turns;                  // (n, T), as PreparedMotions'
  std::unique_ptr<Emulator> emulator;
};

// Fits the scheme to prepared motions; `where`, `data` and `procedural` are the caller's to fill.
MotionEmulator fit_motions(const PreparedMotions& prepared, const Scheme& scheme,
                           const SchemeOptions& options, int threads = 0);

// New motions on SMPL's mean body: sampled postures as rotations, each limb's turn the clips' mean
// one at that time. `timing`: as long as one of the clips, drawn by chance, and with its warping;
// else of the clips' mean length, and even.
std::vector<Clip> sample_clips(const MotionEmulator& motions, std::size_t count, std::uint64_t seed,
                               bool timing, double fps);

void save_motion_emulator(const std::filesystem::path& path, const MotionEmulator& motions);
// Throws DataError naming the key that is not as it should be.
MotionEmulator load_motion_emulator(const std::filesystem::path& path);

}  // namespace mocaplm
