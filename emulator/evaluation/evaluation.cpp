#include "emulator/evaluation/evaluation.h"

#include <cmath>
#include <memory>

#include "common/error.h"
#include "common/progress.h"
#include "common/random.h"
#include "common/settings.h"
#include "common/text.h"
#include "emulator/evaluation/split.h"
#include "motion/chosen_clips.h"

namespace mocaplm {

namespace {

using Eigen::Index;

struct NamedClass {
  std::string name;  // "walk"
  std::vector<DatasetEntry> entries;
};

std::vector<NamedClass> classes_of(const Dataset& dataset, const EvaluationOptions& options) {
  if (options.label.empty()) {
    if (!options.values.empty()) throw UsageError("--values needs --label");
    return {{options.where.empty() ? "all clips" : join(options.where, " "),
             chosen_entries(dataset, "", options.where)}};
  }
  check_label(dataset, options.label, "--label");
  const std::vector<DatasetEntry> entries = chosen_entries(dataset, "", options.where);
  std::vector<NamedClass> classes;
  for (const std::string& value :
       options.values.empty() ? dataset.label_values(options.label) : options.values) {
    check_label_value(dataset, options.label, value, "--values");
    NamedClass one{value, {}};
    for (const DatasetEntry& entry : entries) {
      const auto label = entry.labels.find(options.label);
      if (label != entry.labels.end() && label->second == value) one.entries.push_back(entry);
    }
    classes.push_back(std::move(one));
  }
  return classes;
}

std::vector<Clip> load_clips(const Dataset& dataset, const std::vector<DatasetEntry>& entries) {
  std::vector<Clip> clips;
  for (const DatasetEntry& entry : entries) {
    if (entry.frames < 2)
      throw DataError(in_file((dataset.directory / entry.file).string()),
                      "has one frame, expected two or more: a motion goes from one to another");
    clips.push_back(load_clip(dataset, entry));
  }
  return clips;
}

struct PreparedSplit {
  std::vector<PostureSequence> fit, test;
};

std::string place_of(const Dataset& dataset, const NamedClass& named) {
  return named.name + " of " + dataset.directory.string();
}

ClipSplit split_class(const Dataset& dataset, const NamedClass& named,
                      const EvaluationOptions& options, std::int64_t seed) {
  return split_clips(named.entries, options.test_share, static_cast<std::uint64_t>(seed),
                     place_of(dataset, named));
}

PreparedSplit prepare_split(const Dataset& dataset, const ClipSplit& split,
                            const EvaluationOptions& options) {
  const int threads = static_cast<int>(options.threads);
  const PreparedMotions prepared =
      prepare_motions(load_clips(dataset, split.fit), options.landmarks, options.align, threads);
  return {prepared.sequences(), prepare_like(prepared, load_clips(dataset, split.test), threads)};
}

// Throws DataError where there is no variation, in the clips fitted to or in the unseen ones.
void check_variation(const std::vector<PostureSequence>& sequences, const std::string& place) {
  for (const PostureSequence& one : sequences)
    if ((one.values - sequences[0].values).cwiseAbs().maxCoeff() > 1e-9) return;
  throw DataError(in_file(place),
                  "clips are the same motion again and again, expected ones that "
                  "differ: there is no variation to emulate");
}

std::vector<ClassMotions> parts_of(const NamedClass& named, const PreparedSplit& split,
                                   const std::vector<MotionPart>& parts,
                                   const EvaluationOptions& options) {
  std::vector<ClassMotions> all;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto cut = [&](const std::vector<PostureSequence>& sequences) {
      std::vector<PostureSequence> cut_ones;
      for (const PostureSequence& one : sequences) cut_ones.push_back(part_of(one, parts[i]));
      return cut_ones;
    };
    all.emplace_back(named.name + (parts[i].whole() ? "" : " " + options.parts[i] + " %"),
                     cut(split.fit), cut(split.test), static_cast<int>(options.threads));
  }
  return all;
}

SchemeTestOptions test_options(const EvaluationOptions& options, std::int64_t seed) {
  SchemeTestOptions test;
  test.scheme = options.options;
  test.energy.alpha = options.alpha;
  test.energy.permutations = options.permutations;
  test.energy.seed = test.seed = static_cast<std::uint64_t>(seed);
  test.samples = options.samples;
  test.threads = static_cast<int>(options.threads);
  return test;
}

EnergyTest real_test(const ClassMotions& motions, const EnergyOptions& energy) {
  return energy_test(
      joined_distances(motions.test_distances(), motions.fit_distances(), motions.cross()),
      motions.packed_test().count(), energy);
}

ClassReport describe_class(const ClassMotions& motions, const SchemeTestOptions& test) {
  ClassReport report;
  report.name = motions.name();
  report.fit = motions.fit().size();
  report.test = motions.test().size();
  report.frames = motions.fit()[0].frames();
  report.real = real_test(motions, test.energy);
  report.real_spread = mean_pair(motions.fit_distances()) / mean_pair(motions.test_distances());
  report.fit_steps = mean_steps(motions.fit());
  report.test_steps = mean_steps(motions.test());
  report.real_roughness = report.fit_steps.mean() / report.test_steps.mean();
  report.fit_distances = motions.fit_distances();
  report.test_distances = motions.test_distances();
  report.cross = motions.cross();
  return report;
}

// Table 1's rows: the paper's two representations.
std::vector<RepresentationError> representation_errors(const ClassMotions& motions,
                                                       const SchemeTestOptions& test) {
  std::vector<RepresentationError> errors;
  for (const char* representation : {"IS-TVF", "SIEM"}) {
    const auto emulator =
        fit_emulator(motions.fit(), parse_scheme(std::string(representation) + "/SequentialPCA/IG"),
                     test.scheme, test.threads);
    errors.push_back({representation, emulator->d1(), emulator->d2(),
                      reconstruction_error(*emulator, motions.fit(), 0, 0, test.threads),
                      reconstruction_error(*emulator, motions.test(), 0, 0, test.threads)});
  }
  return errors;
}

void test_schemes(const ClassMotions& motions, const std::vector<Scheme>& schemes,
                  const Evaluation& evaluation, const SchemeTestOptions& test, Progress& progress,
                  ClassReport& report) {
  const PostureClusters& clusters = evaluation.clusters;
  const QuantisedSettings settings{static_cast<int>(evaluation.options.window),
                                   static_cast<int>(evaluation.options.step)};
  const std::vector<Symbols> fit = quantise_all(motions.fit(), clusters, test.threads);
  const Symbols mean = quantise(mean_sequence(motions.fit(), test.threads), clusters);
  const auto quantised = [&](const std::vector<PostureSequence>& sample) {
    return test_quantised(quantise_all(sample, clusters, test.threads), fit, mean, clusters.count(),
                          settings);
  };
  report.original = quantised(motions.fit());
  report.unseen = quantised(motions.test());
  for (const Scheme& scheme : schemes) {
    SchemeResult result = test_scheme(motions, scheme, test);
    report.quantised.push_back(result.samples.empty() ? QuantisedResult{}
                                                      : quantised(result.samples));
    result.samples.clear();
    report.schemes.push_back(std::move(result));
    progress.add(report.name + " " + to_string(scheme));
  }
}

// Further splits: p-values alone. One entry a part.
void test_further_split(const std::vector<ClassMotions>& parts, const std::vector<Scheme>& schemes,
                        const SchemeTestOptions& test, Progress& progress,
                        std::vector<ClassReport*> reports) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<double> p = {real_test(parts[i], test.energy).p};
    for (const Scheme& scheme : schemes) {
      p.push_back(test_scheme(parts[i], scheme, test).unseen.p);
      progress.add(parts[i].name() + " " + to_string(scheme) + ", split " +
                   std::to_string(test.seed));
    }
    reports[i]->splits.push_back(std::move(p));
  }
}

std::vector<Scheme> parse_schemes(const std::vector<std::string>& names) {
  if (names.empty()) throw UsageError("--scheme names no scheme");
  std::vector<Scheme> schemes;
  for (const std::string& name : names) schemes.push_back(parse_scheme(name));
  return schemes;
}

// A class, tested: the parts of its first split, then the other splits.
struct TestedClass {
  NamedClass named;
  std::vector<ClassMotions> parts;
};

// A class whose clips cannot be split into some to fit to and others to test against, or do not
// vary, is left out where all values of a label are asked for.
std::vector<TestedClass> prepare_classes(const Dataset& dataset, const EvaluationOptions& options,
                                         const std::vector<MotionPart>& parts,
                                         Evaluation& evaluation) {
  std::vector<NamedClass> named = classes_of(dataset, options);
  const bool may_leave_out = !options.label.empty() && options.values.empty();
  std::vector<TestedClass> classes;
  Progress progress("aligning", named.size(), "classes");
  for (NamedClass& one : named) {
    progress.add(one.name);
    const auto refused = [&](const auto& check) {
      try {
        check();
        return false;
      } catch (const DataError& error) {
        if (!may_leave_out) throw;
        evaluation.left_out.emplace_back(one.name, error.what());
        return true;
      }
    };
    ClipSplit split;
    if (refused([&] { split = split_class(dataset, one, options, options.seed); })) continue;
    const PreparedSplit prepared = prepare_split(dataset, split, options);
    if (refused([&] {
          check_variation(prepared.fit, place_of(dataset, one));
          check_variation(prepared.test, place_of(dataset, one));
        }))
      continue;
    std::vector<ClassMotions> cut = parts_of(one, prepared, parts, options);
    classes.push_back({std::move(one), std::move(cut)});
  }
  progress.finish();
  if (classes.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "no value of " + options.label + " has the " +
                        std::to_string(kFewestToFit + kFewestToTest) +
                        " clips that a test needs: some to fit to and unseen others (" +
                        evaluation.left_out[0].second + ")");
  return classes;
}

PostureClusters clusters_of(const std::vector<TestedClass>& classes,
                            const EvaluationOptions& options) {
  std::vector<const PostureSequence*> all;
  for (const TestedClass& one : classes)
    for (const ClassMotions& part : one.parts)
      for (const PostureSequence& sequence : part.fit()) all.push_back(&sequence);
  return find_posture_clusters(
      all, static_cast<std::size_t>(options.postures), static_cast<int>(options.clusters),
      static_cast<std::uint64_t>(options.seed), static_cast<int>(options.threads));
}

}  // namespace

Json evaluation_settings(const EvaluationOptions& options) {
  Json settings = settings_json(options);
  for (const Json& more : {settings_json(options.landmarks), settings_json(options.align),
                           settings_json(options.options)})
    settings.update(more);
  settings["data"] = options.data.string();
  return settings;
}

MotionPart parse_part(const std::string& text) {
  const std::vector<std::string> ends = split(text, '-');
  const auto fail = [&]() -> MotionPart {
    throw UsageError("--parts " + text +
                     ": expected two shares of the time in per cent, such as "
                     "60-80");
  };
  if (ends.size() != 2) return fail();
  double values[2];
  for (int i = 0; i < 2; ++i) {
    const std::string& end = ends[static_cast<std::size_t>(i)];
    if (end.empty() || end.find_first_not_of("0123456789.") != std::string::npos) return fail();
    try {
      values[i] = std::stod(end) / 100;
    } catch (const std::exception&) {
      return fail();
    }
  }
  if (!(values[0] >= 0 && values[0] < values[1] && values[1] <= 1)) return fail();
  return {values[0], values[1]};
}

PostureSequence part_of(const PostureSequence& sequence, const MotionPart& part) {
  const auto last = static_cast<double>(sequence.frames() - 1);
  const auto from = static_cast<Index>(std::ceil(part.from * last - 1e-9));
  const auto to = static_cast<Index>(std::floor(part.to * last + 1e-9));
  if (to - from < 1)
    throw UsageError("--parts " + format_number(100 * part.from) + "-" +
                     format_number(100 * part.to) + " of " + std::to_string(sequence.frames()) +
                     " frames holds fewer than two: ask for a larger part or more --frames");
  return {sequence.values.middleCols(from, to - from + 1)};
}

Evaluation evaluate_emulation(const EvaluationOptions& options, bool curves) {
  if (options.level_one > 0 && options.level_one < options.level_two + 3)
    throw UsageError("--level-one " + std::to_string(options.level_one) +
                     " leaves fewer than 3 "
                     "motions to fit to beside the " +
                     std::to_string(options.level_two) + " of --level-two");
  const std::vector<Scheme> schemes = parse_schemes(options.scheme);
  std::vector<MotionPart> parts;
  for (const std::string& part : options.parts) parts.push_back(parse_part(part));
  if (parts.empty()) throw UsageError("--parts names no part");
  const Dataset dataset = load_dataset(options.data);
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.procedural = dataset.procedural;
  std::vector<TestedClass> classes = prepare_classes(dataset, options, parts, evaluation);
  evaluation.clusters = clusters_of(classes, options);

  const std::size_t rows = classes.size() * parts.size();
  Progress progress("testing", rows * schemes.size() * static_cast<std::size_t>(options.splits),
                    "schemes");
  for (TestedClass& one : classes) {
    const SchemeTestOptions test = test_options(options, options.seed);
    std::vector<ClassReport> reports;
    for (const ClassMotions& motions : one.parts) {
      ClassReport report = describe_class(motions, test);
      report.errors = representation_errors(motions, test);
      if (curves)
        report.curves.push_back(reconstruction_curve(motions, parse_scheme("SIEM/SequentialPCA/IG"),
                                                     test, {2, 5, 10, 20}, {1, 2, 5, 10, 20, 30}));
      test_schemes(motions, schemes, evaluation, test, progress, report);
      report.splits.push_back({report.real.p});
      for (const SchemeResult& scheme : report.schemes) report.splits[0].push_back(scheme.unseen.p);
      if (options.level_one > 0) {
        TwoLevelOptions two_level;
        two_level.sequences = options.level_one;
        two_level.test = options.level_two;
        report.two_level = two_level_simulation(report.name, motions.fit(), two_level, test);
      }
      reports.push_back(std::move(report));
    }
    one.parts.clear();  // the sequences are not needed again
    std::vector<ClassReport*> pointers;
    for (ClassReport& report : reports) pointers.push_back(&report);
    for (std::int64_t k = 1; k < options.splits; ++k) {
      const std::int64_t seed = options.seed + k;
      const std::vector<ClassMotions> again =
          parts_of(one.named,
                   prepare_split(dataset, split_class(dataset, one.named, options, seed), options),
                   parts, options);
      test_further_split(again, schemes, test_options(options, seed), progress, pointers);
    }
    for (ClassReport& report : reports) evaluation.classes.push_back(std::move(report));
  }
  progress.finish();
  return evaluation;
}

}  // namespace mocaplm
