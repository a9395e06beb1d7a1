#include "evaluate/generated/long_dances.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"
#include "evaluate/generated/motion_measures.h"
#include "motion/chosen_clips.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

constexpr int kParts = 4;  // of a dance, in the table over time

struct Reference {  // one model's view of the data
  std::vector<Clip> clips;
  MotionMeasures data, tokenized;
};

double frozen(const Clip& clip, const Tokenizer& tokenizer) {
  return frozen_share(tokenizer.encode(clip).ids, tokenizer);
}

// With the share of frozen frames, counted once for each pair of frames.
MotionMeasures measure(const Clip& clip, const Tokenizer& tokenizer, double floor) {
  MotionMeasures measures = measure_motion(clip, tokenizer.joints(), floor);
  const double pairs = static_cast<double>(clip.frames() - 1);
  measures.frozen = {frozen(clip, tokenizer) * pairs, pairs};
  return measures;
}

Reference read_reference(const LongOptions& options, const Dataset& dataset,
                         const Tokenizer& tokenizer) {
  const auto entries = chosen_entries(dataset, options.split, options.where);
  std::vector<MotionMeasures> data(entries.size()), tokenized(entries.size());
  Reference reference;
  reference.clips.resize(entries.size());
  parallel_for(entries.size(), options.threads, [&](std::size_t i) {
    const Clip clip = tokenizer.at_rate(load_clip(dataset, entries[i]));
    const Clip told = tokenizer.decode(tokenizer.encode(clip).ids, clip.name, clip.trans.row(0));
    data[i] = measure(clip, tokenizer, toe_level(clip));
    tokenized[i] = measure(told, tokenizer, toe_level(told));
    reference.clips[i] = clip;
  });
  for (std::size_t i = 0; i < entries.size(); ++i) {
    reference.data.add(data[i]);
    reference.tokenized.add(tokenized[i]);
  }
  return reference;
}

struct Dances {
  std::vector<MotionMeasures> each;
  MotionMeasures all;
  std::vector<MotionMeasures> parts = std::vector<MotionMeasures>(kParts);
};

void keep(const Clip& dance, const Tokenizer& tokenizer, Dances& dances) {
  const double floor = toe_level(dance);
  dances.each.push_back(measure(dance, tokenizer, floor));
  dances.all.add(dances.each.back());
  for (int part = 0; part < kParts; ++part) {
    const Eigen::Index first = dance.frames() * part / kParts,
                       end = dance.frames() * (part + 1) / kParts;
    if (end - first < 2) continue;
    MotionMeasures measures = measure(slice(dance, first, end - first), tokenizer, floor);
    const Eigen::RowVector3d way = dance.trans.row(end - 1) - dance.trans.row(0);
    measures.root_end = {std::hypot(way.x(), way.z()), 1};  // from the dance's start
    dances.parts[static_cast<std::size_t>(part)].add(measures);
  }
}

Dances make_dances(const LongOptions& options, const Reference& reference, AskedModel& model) {
  const Tokenizer& tokenizer = model.generator->tokenizer();
  const auto shown =
      static_cast<Eigen::Index>(std::max(1.0, std::round(options.seed_seconds * model.fps())));
  std::vector<const Clip*> prompts;
  for (const Clip& clip : reference.clips)
    if (clip.frames() >= shown) prompts.push_back(&clip);
  if (prompts.empty())
    throw DataError(in_file(options.data.string()),
                    "no clip of split \"" + options.split + "\" lasts " +
                        format_number(options.seed_seconds) + " s; give a shorter --seed-seconds");
  const auto count = static_cast<std::size_t>(options.dances);
  const auto request = [&](std::size_t i) {
    // Evenly drawn; each several times where there are fewer.
    const Clip& clip =
        *prompts[count <= prompts.size() ? i * prompts.size() / count : i % prompts.size()];
    GenerateRequest r;
    r.prompt = slice(clip, 0, shown);
    r.seconds = options.seconds;
    if (options.conditions)
      r.labels =
          known_conditions(tokenizer, model.generator->description().conditions, clip.labels);
    r.sampling = options.sampling;
    r.sampling.seed = (options.sampling.seed + static_cast<std::int64_t>(i)) % 2147483647;
    return r;
  };
  Dances dances;
  ask(model, count, request, [&](std::size_t, GenerateResult&& result) {
    const Eigen::Index before = result.context.frames() - 1;  // the last frame that was shown
    keep(slice(result.clip, before, result.clip.frames() - before), tokenizer, dances);
  });
  return dances;
}

struct Measure {
  std::string name;
  std::function<double(const MotionMeasures&)> value;
};

Measure average(const std::string& name, Average MotionMeasures::*of, double scale = 1) {
  return {name, [of, scale](const MotionMeasures& m) { return scale * (m.*of).value(); }};
}

std::vector<Measure> all_measures(double usual_height) {
  return {average("root: speed, m/s", &MotionMeasures::root_speed),
          average("root: from 2 s before, m", &MotionMeasures::root_2s),
          average("root: from start to end, m", &MotionMeasures::root_end),
          average("root: farthest from start, m", &MotionMeasures::root_farthest),
          average("pelvis: height, m", &MotionMeasures::height),
          {"pelvis: lowest, m", [](const MotionMeasures& m) { return m.lowest; }},
          {"pelvis: highest, m", [](const MotionMeasures& m) { return m.highest; }},
          {"pelvis: most from the data's mean, m",
           [usual_height](const MotionMeasures& m) {
             return std::max(m.highest - usual_height, usual_height - m.lowest);
           }},
          average("frozen frames, %", &MotionMeasures::frozen, 100),
          average("joints: speed, m/s", &MotionMeasures::joint_speed),
          average("joints: acceleration, m/s2", &MotionMeasures::acceleration),
          average("joints: jerk, m/s3", &MotionMeasures::jerk),
          average("feet: on the floor, %", &MotionMeasures::contact, 100),
          average("feet: speed on the floor, m/s", &MotionMeasures::contact_speed),
          average("feet: skating frames, %", &MotionMeasures::skating, 100)};
}

// Nothing to tell where nothing was measured.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Table measure_table(const LongOptions& options, const AskedModel& model, const Reference& reference,
                    const Dances& dances) {
  Table table("dances of " + format_number(options.seconds) + " s, " + model.name,
              {"measure", "data", "data, tokenized", "dances", "least", "most"});
  table.digits({-1, 3, 3, 3, 3, 3});
  for (const Measure& measure : all_measures(reference.data.height.value())) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const MotionMeasures& dance : dances.each) {
      least = std::min(least, measure.value(dance));
      most = std::max(most, measure.value(dance));
    }
    table.row({measure.name, number(measure.value(reference.data)),
               number(measure.value(reference.tokenized)), number(measure.value(dances.all)),
               number(least), number(most)});
  }
  double seconds = 0;
  for (const Clip& clip : reference.clips) seconds += clip.seconds();
  table.note(std::to_string(dances.each.size()) + " dances after " +
             format_number(options.seed_seconds) +
             " s of a clip; data: " + std::to_string(reference.clips.size()) + " clips of " +
             format_fixed(seconds / static_cast<double>(reference.clips.size()), 1) +
             " s on average, at " + format_number(model.fps()) + " frames a second");
  table.note(
      "frozen: no rotation channel moves by more than a bin; on the floor: the toe is less "
      "than 5 cm above it; skating: faster than 0.5 m/s there");
  return table;
}

Table time_table(const LongOptions& options, const AskedModel& model, const Reference& reference,
                 const Dances& dances) {
  const std::vector<Measure> columns = {
      average("root, m/s", &MotionMeasures::root_speed),
      average("from start, m", &MotionMeasures::root_end),
      average("pelvis, m", &MotionMeasures::height),
      average("frozen, %", &MotionMeasures::frozen, 100),
      average("joints, m/s", &MotionMeasures::joint_speed),
      average("jerk, m/s3", &MotionMeasures::jerk),
      average("feet on floor, m/s", &MotionMeasures::contact_speed)};
  std::vector<std::string> names = {"seconds"};
  for (const Measure& column : columns) names.push_back(column.name);
  Table table("over time, " + model.name, names);
  table.digits({-1, 3, 3, 3, 1, 3, 1, 3});
  const auto add = [&](const std::string& name, const MotionMeasures& measures) {
    std::vector<Json> cells = {name};
    for (const Measure& column : columns) cells.push_back(number(column.value(measures)));
    table.row(cells);
  };
  add("data, tokenized", reference.tokenized);
  for (int part = 0; part < kParts; ++part)
    add(format_number(options.seconds * part / kParts) + " to " +
            format_number(options.seconds * (part + 1) / kParts),
        dances.parts[static_cast<std::size_t>(part)]);
  return table;
}

}  // namespace

std::vector<Table> long_tables(const LongOptions& options) {
  std::vector<AskedModel> models = load_models(options, options.dances);
  const Dataset dataset = load_dataset(options.data);
  std::vector<Table> tables;
  for (AskedModel& model : models) {
    const Reference reference = read_reference(options, dataset, model.generator->tokenizer());
    const Dances dances = make_dances(options, reference, model);
    tables.push_back(measure_table(options, model, reference, dances));
    tables.push_back(time_table(options, model, reference, dances));
  }
  return tables;
}

}  // namespace mocaplm
