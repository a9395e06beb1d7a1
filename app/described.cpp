#include "app/described.h"

#include <algorithm>
#include <map>

#include "app/described_parts.h"
#include "common/error.h"
#include "common/settings.h"
#include "common/text.h"
#include "emulator/motions.h"
#include "gesture/model.h"
#include "model/directory.h"
#include "motion/import.h"
#include "motion/inputs.h"
#include "motion/skeleton.h"
#include "tokenizer/any_tokenizer.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::vector<Table> describe_dataset(const fs::path& path) {
  const Dataset dataset = load_dataset(path);
  Table splits = split_table(dataset);
  splits.note("dataset " + path.string());
  if (const std::string trouble = dataset_trouble(dataset); !trouble.empty()) splits.note(trouble);
  if (dataset.label_names().empty()) return {splits};
  return {splits, label_table(dataset)};
}

std::vector<Table> describe_tiles(const fs::path& path, const TileTokenizer& tokenizer) {
  Table table(path.string(), {"tile tokenizer", tokenizer.fingerprint()});
  const Json tiles = settings_json(tokenizer.tiles()), frames = settings_json(tokenizer.frames());
  for (const Json* settings : {&tiles, &frames})
    for (const auto& item : settings->items())
      table.row({item.key(), item.value().is_array() ? Json(value_text(tokenizer.frames().joints))
                                                     : item.value()});
  table.row({"components", tokenizer.components()});
  table.row({"vocabulary", tokenizer.vocabulary()});
  return {table};
}

std::vector<Table> describe_tokenizer(const fs::path& path) {
  const std::unique_ptr<AnyTokenizer> any = load_tokenizer(path);
  if (const auto* tiles = dynamic_cast<const TileWords*>(any.get()))
    return describe_tiles(path, tiles->tokenizer());
  const Tokenizer& tokenizer = dynamic_cast<const FrameWords&>(*any).tokenizer();
  Table table(path.string(), {"tokenizer", tokenizer.fingerprint()});
  table.row({"bins", tokenizer.bins()});
  table.row({"binning", tokenizer.config().binning});
  table.row({"frames per second", tokenizer.config().fps});
  std::vector<std::string> names;
  for (const int joint : tokenizer.joints())
    names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  table.row({"joints", value_text(names)});
  table.row({"root", tokenizer.config().root});
  table.row({"tokens per frame", tokenizer.tokens_per_frame()});
  table.row({"vocabulary", tokenizer.vocabulary()});
  for (const auto& [label, values] : tokenizer.label_values())
    table.row({"label " + label, value_text(values)});
  return {table};
}

std::vector<Table> describe_emulator(const fs::path& path) {
  const MotionEmulator motions = load_motion_emulator(path);
  const Emulator& emulator = *motions.emulator;
  Table table(path.string(), {"emulator", to_string(emulator.scheme())});
  table.row({"class", motions.where.empty() ? "all clips" : join(motions.where, ", ")});
  table.row({"dataset", motions.data});
  table.row({"clips fitted to", motions.seconds.size()});
  table.row({"frames", emulator.frames()});
  table.row({"landmarks", motions.tree.names.size()});
  if (emulator.d1() > 0)
    table.row(
        {"components", std::to_string(emulator.d1()) + " x " + std::to_string(emulator.d2())});
  for (const Json& settings : {settings_json(motions.landmarks), settings_json(motions.align),
                               settings_json(motions.options)})
    for (const auto& item : settings.items()) table.row({item.key(), item.value().dump()});
  return {table};
}

std::vector<Table> describe_gesture(const fs::path& path) {
  const GestureModel model = load_gesture(path);
  Table table(path.string(), {"gesture model", "value"});
  table.row({"made from", model.source});
  for (const PhaseModel& phase : model.phases)
    table.row({"phase " + phase.name,
               std::to_string(phase.demonstrations.size()) + " demonstrations of " +
                   format_fixed(phase.shortest(), 2) + " to " + format_fixed(phase.longest(), 2) +
                   " s; " + join(phase.coordinates, ", ")});
  table.row({"conditions", join(model.phases[0].conditions, ", ")});
  return {table};
}

// Which reader a JSON file is for; files that say it are told by "format".
std::vector<Table> describe_json_file(const fs::path& path, const fs::path& folder) {
  const Json json = load_json(path);
  const std::string format = text_of(json, "format");
  if (path.filename() == "dataset.json" || format == "mocaplm dataset")
    return describe_dataset(folder);
  if (path.filename() == "config.json" && json.is_object() && json.contains("stream"))
    return describe_model(folder);
  if (path.filename() == "tokenizer.json" || format == "mocaplm tokenizer" ||
      format == TileTokenizer::kFormat)
    return describe_tokenizer(path);
  if (format == "mocaplm emulator") return describe_emulator(path);
  if (format == "mocaplm gesture") return describe_gesture(path);
  return describe_json(path, json);
}

std::vector<Table> describe_folder(const fs::path& path) {
  if (is_dataset(path)) return describe_dataset(path);
  if (is_run(path)) return describe_run(path);
  for (const char* model : {"config.json", "best/config.json", "last/config.json"})
    if (fs::exists(path / model)) return describe_model(resolve_model(path));
  if (is_experiment(path)) return describe_experiment(path);
  if (fs::exists(path / "demo.json")) {
    std::vector<Table> tables = describe_json_file(path / "demo.json", path);
    tables[0].note("Its parts: dances, pretrained, model, classifier; open index.html.");
    return tables;
  }
  if (fs::exists(path / "tokenizer.json")) return describe_tokenizer(path / "tokenizer.json");
  if (const std::vector<Table> recordings = describe_recordings(path); !recordings.empty())
    return recordings;
  throw DataError(in_file(path.string()),
                  "is neither a dataset (with a dataset.json) nor a model or training run (with a "
                  "config.json), an experiment, a demo or a folder of motion files");
}

using Describe = std::vector<Table> (*)(const fs::path&);

// By the ending; null for motion files.
Describe describer_of(const std::string& ending) {
  static const std::map<std::string, Describe> all = {
      {".html", describe_page},    {".svg", describe_picture},
      {".txt", describe_corpus},   {".csv", describe_csv},
      {".jsonl", describe_lines},  {".index", describe_index},
      {".model", describe_pieces}, {".safetensors", describe_safetensors},
      {".glb", describe_glb},      {".vrma", describe_glb},
      {".png", describe_film},     {".gif", describe_film},
      {".mp4", describe_film}};
  const auto found = all.find(ending);
  return found == all.end() ? nullptr : found->second;
}

}  // namespace

std::vector<Table> describe_path(const fs::path& path, const ReadOptions& options) {
  if (!fs::exists(path)) throw DataError(in_file(path.string()), "no such file or folder");
  if (fs::is_directory(path)) return describe_folder(path);
  const std::string ending = lower(path.extension().string());
  if (ending == ".json" || path.filename() == "complete")
    return describe_json_file(path, path.has_parent_path() ? path.parent_path() : ".");
  const Describe describe = describer_of(ending);
  if (describe == nullptr) return describe_motion(path, options);
  if (!looks_like_motion(path)) return describe(path);
  // A table of joint positions or a figure, which stays what it is where no motion can be made of
  // it.
  std::vector<Table> tables;
  if (ending != ".csv") tables = describe(path);
  try {
    for (Table& table : describe_motion(path, options)) tables.push_back(std::move(table));
    return tables;
  } catch (const DataError& error) {
    if (tables.empty()) tables = describe(path);
    tables[0].note(std::string("As motion: ") + error.what());
    return tables;
  }
}

std::vector<Table> describe_named(const std::string& text, const ReadOptions& options) {
  if (fs::exists(text)) return describe_path(text, options);
  const ClipRange range = parse_clip_range(text);
  const PartName name = split_part(range.clip);
  if (name.part.empty() && range.clip == text) return describe_path(text, options);
  const MotionInput input = find_motion(text);
  ReadOptions own = input.dataset ? ReadOptions() : options;
  if (!input.dataset && !name.part.empty()) {
    own.part = name.part;
    MotionReading reading;
    static_cast<ReadOptions&>(reading) = options;
    read_motion(input, reading);  // throws where there is no such part
  }
  return describe_motion(input.file(), own, range);
}

}  // namespace mocaplm
