// The paper's whole evaluation, for every class of a dataset and several schemes (sections 4.4 and
// 5 of Chen, Park and Srivastava, "Statistical Emulation of Human Operational Motions").
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "emulator/evaluation/reconstruction.h"
#include "emulator/evaluation/scheme_test.h"
#include "emulator/evaluation/two_level.h"
#include "emulator/motions.h"

namespace mocaplm {

struct EvaluationOptions {
  std::filesystem::path data;
  std::string label;
  std::vector<std::string> values, where;
  std::vector<std::string> scheme = {"IS-TVF/SequentialPCA/MVG", "SIEM/SequentialPCA/MVG", "PWI",
                                     "IS-TVF/SpatialPCA/VAR"};
  std::vector<std::string> parts = {"0-100"};
  double test_share = 0.4;
  std::int64_t splits = 1;
  std::int64_t samples = 60, permutations = 999;
  double alpha = 1;
  std::int64_t postures = 2000, clusters = 0, window = 20, step = 10;
  std::int64_t level_one = 1000, level_two = 200;
  std::int64_t seed = 1, threads = 0;
  LandmarkOptions landmarks;
  AlignOptions align;
  SchemeOptions options;

  template <class Visitor>
  void describe(Visitor& v) {
    v.text("label", label,
           "test every value of this label as a class of its own; empty: one class");
    v.texts("values", values, "only these values of --label");
    v.texts("where", where, "only clips with label=value");
    v.texts("scheme", scheme, "schemes to test, comma separated");
    v.texts("parts", parts, "sub-sequences, in per cent of the time: 0-100,60-80");
    v.number("test_share", test_share, 0.01, 0.99, "share of a class's clips that stay unseen");
    v.integer("splits", splits, 1, 1000,
              "seeded splits; those after the first only for Table 2's p-values");
    v.integer("samples", samples, 2, 100000, "motions simulated of each class and scheme");
    v.integer("permutations", permutations, 19, 1000000, "of a two-sample test");
    v.number("alpha", alpha, 0.01, 2, "power of the distances in a two-sample test");
    v.integer("postures", postures, 10, 20000, "drawn of all classes to find posture clusters");
    v.integer("clusters", clusters, 0, 1000, "posture clusters; 0: as many as the data have");
    v.integer("window", window, 1, 100000, "frames of a transition matrix");
    v.integer("step", step, 1, 100000, "frames from one transition matrix to the next");
    v.integer("level_one", level_one, 0, 100000,
              "motions simulated at level one of Table 3; 0: no two-level simulation");
    v.integer("level_two", level_two, 2, 50000,
              "of them set aside, and simulated at level two to compare");
    v.integer("seed", seed, 0, 1000000000, "of splits, samples and tests");
    v.integer("threads", threads, 0, 1024, "0: all cores");
  }
};

// All of them in one object, with "data", the dataset's folder.
Json evaluation_settings(const EvaluationOptions& options);

// Share [from, to] of a motion's time.
struct MotionPart {
  double from = 0, to = 1;
  bool whole() const { return from == 0 && to == 1; }
};
// "60-80" -> 0.6 to 0.8. Throws UsageError.
MotionPart parse_part(const std::string& text);
// Its frames of T, at least 2. Throws UsageError when it has fewer.
PostureSequence part_of(const PostureSequence& sequence, const MotionPart& part);

struct RepresentationError {
  std::string representation;
  Eigen::Index d1 = 0, d2 = 0;
  double fit = 0, unseen = 0;
};

// What was found of one class (or a part of its time).
struct ClassReport {
  std::string name;
  std::size_t fit = 0, test = 0;  // clips
  Eigen::Index frames = 0;
  EnergyTest real;            // unseen clips against those fitted to
  double real_spread = 0;     // mean distance within those fitted to, by that within the unseen
  double real_roughness = 0;  // the same of the mean steps
  Eigen::VectorXd fit_steps, test_steps;
  Eigen::MatrixXd fit_distances, test_distances, cross;  // (test, fit)
  QuantisedResult original, unseen;
  std::vector<RepresentationError> errors;
  std::vector<ReconstructionCurve> curves;
  std::vector<SchemeResult> schemes;       // without their samples
  std::vector<QuantisedResult> quantised;  // of each scheme
  std::vector<TwoLevelResult> two_level;
  // p against unseen clips, split after split: real first, then each scheme.
  std::vector<std::vector<double>> splits;
};

struct Evaluation {
  EvaluationOptions options;
  bool procedural = false;
  std::vector<ClassReport> classes;
  PostureClusters clusters;
  std::vector<std::pair<std::string, std::string>> left_out;  // class, why
};

// `curves`: also the reconstruction error over a grid of components, for a plot. A class that
// cannot be tested is left out, with the reason, when all values of a label are asked for. Throws
// DataError when none is left, one was asked for by name, or a clip is not sound; UsageError for
// schemes, parts and labels that do not exist.
Evaluation evaluate_emulation(const EvaluationOptions& options, bool curves);

}  // namespace mocaplm
