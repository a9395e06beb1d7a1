#include "app/described.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/settings.h"
#include "common/text.h"
#include "emulator/motions.h"
#include "model/directory.h"
#include "motion/formats/aist.h"
#include "motion/formats/formats.h"
#include "motion/formats/retarget.h"
#include "motion/import.h"
#include "motion/skeleton.h"
#include "tokenizer/any_tokenizer.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string label_text(const Labels& labels) {
  std::vector<std::string> parts;
  for (const auto& [label, value] : labels) parts.push_back(label + " " + value);
  return parts.empty() ? "none" : join(parts, ", ");
}

// What the names of clips and the labels of a model or tokenizer may be, shortened.
std::string value_text(std::vector<std::string> values) {
  const std::size_t count = values.size();
  if (count > 12) values.resize(12);
  return std::to_string(count) + ": " + join(values, ", ") + (count > 12 ? ", ..." : "");
}

void add_floor_rows(Table& table, const Clip& clip) {
  double lowest = 1e9;
  for (Eigen::Index t = 0; t < clip.frames(); ++t) {
    const JointPositions joints = joint_positions(clip, t);
    lowest = std::min({lowest, joints(7, 1), joints(8, 1), joints(10, 1), joints(11, 1)});
  }
  double way = 0;
  for (Eigen::Index t = 1; t < clip.frames(); ++t)
    way += std::hypot(clip.trans(t, 0) - clip.trans(t - 1, 0),
                      clip.trans(t, 2) - clip.trans(t - 1, 2));
  const Eigen::RowVector3d low = clip.trans.colwise().minCoeff() + rest_joints().row(0);
  const Eigen::RowVector3d high = clip.trans.colwise().maxCoeff() + rest_joints().row(0);
  table.row(
      {"pelvis height", format_fixed(low.y(), 2) + " to " + format_fixed(high.y(), 2) + " m"});
  table.row({"lowest foot joint", format_fixed(lowest, 3) + " m"});
  table.row({"way of the pelvis over the floor", format_fixed(way, 2) + " m"});
}

std::vector<Table> describe_clip(const fs::path& path) {
  RetargetReport retarget;
  const Clip clip = read_clip(path, {}, &retarget);
  Table table(path.string(), {"motion file", lower(path.extension().string()).substr(1)});
  table.row({"frames", clip.frames()});
  table.row({"frames per second", clip.fps});
  table.row({"length", format_fixed(clip.seconds(), 2) + " s"});
  table.row(
      {"labels of its name", label_text(aist_labels(path.stem().string()).value_or(Labels{}))});
  add_floor_rows(table, clip);
  if (!retarget.scheme.empty()) {
    table.row({"skeleton", retarget.scheme});
    table.row(
        {"limb directions off by", format_number(retarget.mean_degrees) + " degrees on average"});
    if (!retarget.unmatched.empty())
      table.row({"SMPL joints without a source", join(retarget.unmatched, ", ")});
  }
  return {table};
}

std::vector<Table> describe_dataset(const fs::path& path) {
  const Dataset dataset = load_dataset(path);
  Table splits = split_table(dataset);
  splits.note("dataset " + path.string());
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

// A damaged file is the tokenizer reader's to complain about.
bool is_emulator(const fs::path& path) {
  const std::string head = read_head(path, 40);
  return head.find("\"mocaplm emulator\"") != std::string::npos;
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

std::vector<Table> describe_model(const fs::path& path) {
  const ModelDescription model = load_description(path);
  check_complete(path);
  Table table(path.string(), {"model", model.config.architecture});
  const Json settings = settings_json(model.config);  // items() only points into it
  for (const auto& item : settings.items())
    if (item.key() != "architecture") table.row({item.key(), item.value()});
  table.row({"vocabulary", model.shape.vocabulary});
  table.row({model.has_pieces() ? "characters per frame" : "tokens per frame",
             model.shape.tokens_per_frame()});
  table.row({"tokenizer", model.tokenizer_fingerprint});
  if (model.has_pieces())
    table.row({"pieces", std::to_string(model.shape.pieces) + " of 2 to " +
                             std::to_string(model.shape.longest) + " characters, fingerprint " +
                             model.pieces_fingerprint});
  table.row({"conditions", model.conditions.empty() ? "none" : join(model.conditions, ", ")});
  for (const auto& [label, values] : model.classes)
    table.row({"classifies " + label, value_text(values)});
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path / "model.safetensors", error);
  if (!error) table.row({"parameters, about", bytes / sizeof(float)});
  if (model.procedural) table.note("Trained on procedural dances only: rules made them.");
  return {table};
}

}  // namespace

std::vector<Table> describe_path(const fs::path& path) {
  if (!fs::exists(path)) throw DataError(in_file(path.string()), "no such file or folder");
  if (fs::is_directory(path)) {
    if (is_dataset(path)) return describe_dataset(path);
    for (const char* model : {"config.json", "best/config.json", "last/config.json"})
      if (fs::exists(path / model)) return describe_model(resolve_model(path));
    throw DataError(in_file(path.string()),
                    "is neither a dataset (with a dataset.json) nor a model "
                    "or training run (with a config.json)");
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (path.filename() == "dataset.json") return describe_dataset(folder);
  if (path.filename() == "config.json") return describe_model(folder);
  if (path.extension() == ".json")
    return is_emulator(path) ? describe_emulator(path) : describe_tokenizer(path);
  return describe_clip(path);
}

}  // namespace mocaplm
