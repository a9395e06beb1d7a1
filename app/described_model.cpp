#include <algorithm>
#include <sstream>

#include "app/described_parts.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "model/directory.h"
#include "tokenizer/sentencepiece_file.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// The lines of log.jsonl, one for each validation.
std::vector<Json> run_log(const fs::path& file) {
  std::vector<Json> all;
  if (!fs::exists(file)) return all;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) all.push_back(parse_json(line, file.string()));
  return all;
}

Json object_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : Json::object();
}

void add_log_rows(Table& table, const std::vector<Json>& log) {
  if (log.empty()) {
    table.row({"validations", "none yet"});
    return;
  }
  const Json& last = log.back();
  const Json* best = &last;
  for (const Json& line : log)
    if (number_of(line, "validation_loss") < number_of(*best, "validation_loss")) best = &line;
  table.row({"validation",
             format_fixed(number_of(*best, "validation_bits_per_frame"), 2) +
                 " bits/frame at best (step " + format_number(number_of(*best, "step")) + "), " +
                 format_fixed(number_of(last, "validation_bits_per_frame"), 2) + " at last"});
  table.row({"trained for", format_duration(number_of(last, "seconds")) + " at " +
                                format_fixed(number_of(last, "tokens_per_second"), 0) +
                                " tokens/s"});
}

}  // namespace

double number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0;
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string value_text(std::vector<std::string> values) {
  constexpr std::size_t kMost = 24;  // all of SMPL's joints
  const std::size_t count = values.size();
  if (count == 0) return "none";
  if (count > kMost) values.resize(kMost);
  return std::to_string(count) + ": " + join(values, ", ") + (count > kMost ? ", ..." : "");
}

std::vector<Table> describe_model(const fs::path& path) {
  const ModelDescription model = load_description(path);
  check_complete(path);
  Table table(path.string(), {model.classes.empty() ? "model" : "classifier on a model",
                              model.config.architecture});
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

bool is_run(const fs::path& folder) {
  return fs::exists(folder / "settings.json") &&
         (fs::exists(folder / "log.jsonl") || fs::exists(folder / "last") ||
          fs::exists(folder / "best"));
}

std::vector<Table> describe_run(const fs::path& folder) {
  const Json settings = load_json(folder / "settings.json");
  const Json train = object_of(object_of(settings, "config"), "train");
  Table table(folder.string(), {"training run", "value"});
  table.row({"dataset", text_of(settings, "data")});
  if (const std::string from = text_of(settings, "from"); !from.empty())
    table.row({"fine-tunes", from});
  const fs::path state = folder / "last" / "state.json";
  const bool saved = fs::exists(state);
  const double step = saved ? number_of(load_json(state), "step") : 0,
               steps = number_of(train, "steps");
  table.row(
      {"steps", format_number(step) + " of " + format_number(steps) +
                    (number_of(train, "max_minutes") > 0
                         ? ", or " + format_number(number_of(train, "max_minutes")) + " minutes"
                         : "")});
  const std::vector<Json> log = run_log(folder / "log.jsonl");
  add_log_rows(table, log);
  table.row({"goes on with", saved ? "train --resume --out " + folder.string()
                                   : "nothing: no checkpoint was saved"});
  std::vector<Table> tables = {table};
  for (const char* model : {"best", "last"})
    if (fs::exists(folder / model / "config.json")) {
      tables.push_back(describe_model(folder / model)[0]);
      break;
    }
  if (tables.size() == 1 && !log.empty())
    throw DataError(in_file(folder.string()),
                    "is a training run of " + std::to_string(log.size()) +
                        " validations, but its models (best, last) are gone");
  return tables;
}

bool is_experiment(const fs::path& folder) {
  if (fs::exists(folder / "request.json")) return true;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && fs::exists(entry.path() / "request.json")) return true;
  return false;
}

std::vector<Table> describe_experiment(const fs::path& folder) {
  std::vector<fs::path> rows;
  if (fs::exists(folder / "request.json")) rows.push_back(folder);
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && fs::exists(entry.path() / "request.json"))
      rows.push_back(entry.path());
  std::sort(rows.begin(), rows.end());
  Table table(folder.string(), {"row of an experiment", "state"});
  for (const fs::path& row : rows) {
    const std::string name = text_of(load_json(row / "request.json"), "name");
    const fs::path state = row / "run" / "last" / "state.json";
    table.row({name.empty() ? row.filename().string() : name,
               fs::exists(row / "result.json") ? "finished"
               : fs::exists(state) ? "at step " + format_number(number_of(load_json(state), "step"))
                                   : "begun"});
  }
  if (fs::exists(folder / "table.json"))
    table.note("All rows are done: " + (folder / "table.json").string());
  else
    table.note("The same mocaplm experiment goes on where it was cut off.");
  return {table};
}

std::vector<Table> describe_safetensors(const fs::path& file) {
  const TensorMap tensors = read_safetensors(file);
  double values = 0;
  std::vector<std::string> names;
  for (const auto& [name, tensor] : tensors) {
    values += static_cast<double>(tensor.size());
    names.push_back(name);
  }
  Table table(file.string(), {"weights (safetensors)", "value"});
  table.row({"tensors", value_text(names)});
  table.row({"values in all", format_number(values)});
  table.note("A model is the folder around it: mocaplm info " + file.parent_path().string());
  return {table};
}

std::vector<Table> describe_pieces(const fs::path& file) {
  const SentencePieceFile pieces = parse_sentencepiece(read_file(file), file.string());
  Table table(file.string(), {"pieces of words (SentencePiece)", pieces.bpe ? "BPE" : "unigram"});
  table.row({"pieces", pieces.pieces.size()});
  return {table};
}

}  // namespace mocaplm
