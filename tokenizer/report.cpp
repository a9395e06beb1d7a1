#include "tokenizer/report.h"

#include <map>

#include "common/error.h"
#include "common/progress.h"
#include "common/settings.h"
#include "motion/skeleton.h"
#include "tokenizer/alphabet.h"

namespace mocaplm {

namespace {

constexpr double kContext = 1024;  // tokens: the thesis's block size

// Texts by key, made JSON of the type that a struct declares for the key.
class TypedSettings {
 public:
  explicit TypedSettings(const std::map<std::string, std::string>& texts) : texts_(texts) {}
  void integer(const char* key, std::int64_t&, std::int64_t, std::int64_t, const char*) {
    number(key);
  }
  void number(const char* key, double&, double, double, const char*) { number(key); }
  void boolean(const char* key, bool&, const char*) {
    if (const std::string* text = find(key))
      json_[key] = text->empty() || *text == "true" ? Json(true)
                   : *text == "false"               ? Json(false)
                                                    : Json(*text);
  }
  void choice(const char* key, std::string&, const std::vector<std::string>&, const char*) {
    if (const std::string* text = find(key)) json_[key] = *text;
  }
  void text(const char* key, std::string&, const char*) {
    if (const std::string* text = find(key)) json_[key] = *text;
  }
  void texts(const char* key, std::vector<std::string>&, const char*) {
    if (const std::string* text = find(key)) json_[key] = split(*text, '+');
  }
  const std::vector<std::string>& keys() const { return keys_; }
  const Json& json() const { return json_; }

 private:
  const std::string* find(const char* key) {
    keys_.push_back(key);
    const auto found = texts_.find(key);
    return found == texts_.end() ? nullptr : &found->second;
  }
  void number(const char* key) {
    const std::string* text = find(key);
    if (text == nullptr) return;
    const Json value = Json::parse(*text, nullptr, false);
    json_[key] = value.is_number() ? value : Json(*text);  // a text is refused by name later
  }
  const std::map<std::string, std::string>& texts_;
  std::vector<std::string> keys_;
  Json json_ = Json::object();
};

Json parse_spec(const std::string& spec) {
  std::map<std::string, std::string> texts;
  for (const std::string& part : split(spec, ',')) {
    const std::size_t at = part.find(':');
    texts[part.substr(0, at)] = at == std::string::npos ? "" : part.substr(at + 1);
  }
  TypedSettings typed(texts);
  TokenizerConfig frames;
  TileConfig tiles;
  frames.describe(typed);
  tiles.describe(typed);
  PieceConfig().describe(typed);
  for (const auto& [key, text] : texts) {
    if (!typed.json().contains(key))
      throw UsageError("report \"" + spec + "\": there is no setting \"" + key + "\"" +
                       known_names(key, typed.keys()));
  }
  return typed.json();
}

ReportSetting read_setting(const std::string& name, const Json& json, const ReportSetting& base) {
  ReportSetting setting = base;
  setting.name = name;
  try {
    JsonObject object(json, "report \"" + name + "\"");
    read_settings(setting.frames, object);
    read_settings(setting.tiles, object);
    read_settings(setting.pieces, object);
    object.finish();
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
  // Tiles cannot tell steps; who says nothing of the root means none.
  if (setting.tiles.tiles > 0 && setting.frames.root == "steps" && !json.contains("root"))
    setting.frames.root = "none";
  return setting;
}

// {"tiles": 60, "lapped": true} -> "tiles:60,lapped:true"
std::string spec_of(const Json& json) {
  std::vector<std::string> parts;
  for (const auto& item : json.items())
    parts.push_back(
        item.key() + ":" +
        (item.value().is_string() ? item.value().get<std::string>() : item.value().dump()));
  return join(parts, ",");
}

// What tiles see of the clips, made once for all settings that see the same.
class ValueCache {
 public:
  explicit ValueCache(const std::vector<Clip>& clips) : clips_(clips) {}
  const std::vector<Eigen::MatrixXd>& of(const TokenizerConfig& frames) {
    const std::string key =
        format_number(frames.fps) + " " + frames.root + " " + join(frames.joints, "+");
    if (key != key_) {
      values_.clear();
      const std::vector<int> joints = parse_joints(frames.joints);
      for (const Clip& clip : clips_)
        values_.push_back(TileTokenizer::channel_values(frames, joints, clip));
      key_ = key;
    }
    return values_;
  }

 private:
  const std::vector<Clip>& clips_;
  std::string key_;
  std::vector<Eigen::MatrixXd> values_;
};

// Pieces learnt on the text of `fitted`; counts those that the text of `held_out` takes.
void measure_pieces(const PieceConfig& config, const AnyTokenizer& tokenizer,
                    const std::vector<Clip>& fitted, const std::vector<Clip>& held_out,
                    WordMeasure& measure) {
  const Pieces pieces =
      learn_pieces(config, tokenizer, fitted.size(), [&](std::size_t i) { return fitted[i]; });
  for (const Clip& clip : held_out)
    measure.pieces += static_cast<std::int64_t>(
        pieces.encode(tokenizer.to_text(tokenizer.encode(clip).ids)).size());
  measure.dictionary_bytes = 0;
  for (std::int32_t id = 1; id < pieces.size(); ++id)
    measure.dictionary_bytes += static_cast<std::int64_t>(pieces.text(id).size());
}

}  // namespace

Pieces learn_pieces(const PieceConfig& config, const AnyTokenizer& tokenizer, std::size_t count,
                    const std::function<Clip(std::size_t)>& clip) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < count; ++i)
    lines.push_back(tokenizer.to_text(tokenizer.encode(clip(i)).ids));
  std::string alphabet;
  for (int c = 0; c < tokenizer.characters(); ++c) append_utf8(alphabet, bin_character(c));
  return Pieces::train(config, lines, alphabet);
}

std::vector<ReportSetting> report_settings(const std::vector<std::string>& specs,
                                           const ReportSetting& base) {
  std::vector<ReportSetting> settings;
  for (const std::string& spec : specs) {
    if (spec.size() <= 5 || lower(spec).substr(spec.size() - 5) != ".json") {
      settings.push_back(read_setting(spec, parse_spec(spec), base));
      continue;
    }
    const Json list = load_json(spec);
    if (!list.is_array() || list.empty())
      throw DataError(in_file(spec), "expected a list of settings, [{\"tiles\": 60}, ...]");
    for (const Json& one : list) settings.push_back(read_setting(spec_of(one), one, base));
  }
  return settings;
}

std::vector<ReportRow> report(const std::vector<ReportSetting>& settings,
                              const std::vector<Clip>& fitted, const std::vector<Clip>& held_out) {
  std::vector<ReportRow> rows;
  ValueCache values(fitted);
  Progress progress("report", settings.size(), "settings");
  for (const ReportSetting& setting : settings) {
    std::unique_ptr<AnyTokenizer> tokenizer;
    if (setting.tiles.tiles > 0) {
      tokenizer = std::make_unique<TileWords>(
          TileTokenizer::fit_values(setting.frames, setting.tiles, values.of(setting.frames)));
    } else {
      tokenizer = std::make_unique<FrameWords>(
          Tokenizer::fit(setting.frames, fitted.size(), [&](std::size_t i) { return fitted[i]; }));
    }
    ReportRow row{setting, start_measure(*tokenizer)};
    for (const Clip& clip : held_out) measure_clip(*tokenizer, clip, row.measure);
    if (setting.pieces.any())
      measure_pieces(setting.pieces, *tokenizer, fitted, held_out, row.measure);
    rows.push_back(std::move(row));
    progress.add(setting.name);
  }
  return rows;
}

Table report_table(const std::vector<ReportRow>& rows) {
  Table table("Tokenizers on held-out clips",
              {"setting", "word", "longest", "compression", "seconds", "in fact", "geodesic",
               "geodesic max", "eq. 4.7 frame", "eq. 4.7 joint", "eq. 4.7 joint max", "cm",
               "cm max", "seam"});
  table.digits({-1, 1, 0, 1, 2, 2, 4, 3, 4, 4, 3, 2, 1, 2});
  for (const ReportRow& row : rows) {
    const WordMeasure& m = row.measure;
    table.row({row.setting.name, m.word_length(), m.longest, m.compression(),
               m.seconds_in(kContext), m.seconds_in_fact(kContext), m.geodesic.mean(),
               m.geodesic.max, m.frame_vectors.mean(), m.joint_vectors.mean(), m.joint_vectors.max,
               m.position.mean(), m.position.max, m.seam()});
  }
  table.note(
      "word: tokens of a word, characters or pieces; longest: characters; compression: bytes of "
      "the SMPL values over tokens and dictionary");
  table.note(
      "seconds: in 1,024 tokens as the thesis counts them (no separators); in fact: with "
      "separators and filled up last words");
  table.note(
      "geodesic, eq. 4.7: mean error in radians, of each joint's rotation, of a frame's "
      "vector of rotations, of each joint's rotation vector; cm: joint positions");
  table.note(
      "seam: change of the error from frame to frame at the borders of words over that "
      "inside words");
  return table;
}

}  // namespace mocaplm
