#include "tokenizer/corpus.h"

#include <algorithm>
#include <set>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr const char* kCorpusFormat = "mocaplm corpus";

bool plain_name(const std::string& name) {
  if (name.empty() || name.size() > 200 || name[0] == '.') return false;
  for (const char c : name)
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20) return false;
  return true;
}

// Frames of all words together; of the last one some may not have been there.
std::int64_t frames_told(const AnyTokenizer& tokenizer, const std::vector<std::int32_t>& ids) {
  return std::count(ids.begin(), ids.end(), Tokenizer::kSeparator) * tokenizer.word_frames();
}

Json index_json(const AnyTokenizer& tokenizer, const std::vector<CorpusClip>& clips) {
  Json json;
  json["format"] = kCorpusFormat;
  json["version"] = 1;
  json["tokenizer"] = tokenizer.fingerprint();
  Json lines = Json::array();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const CorpusClip& clip = clips[i];
    Json labels = Json::object();
    for (const auto& [label, value] : clip.labels) labels[label] = value;
    lines.push_back({{"line", i + 1},
                     {"name", clip.name},
                     {"frames", clip.frames > 0 ? clip.frames : frames_told(tokenizer, clip.ids)},
                     {"start", {clip.start.x(), clip.start.y(), clip.start.z()}},
                     {"labels", labels}});
  }
  json["clips"] = lines;
  return json;
}

void read_index_entry(JsonObject& entry, std::size_t line, const AnyTokenizer& tokenizer,
                      CorpusClip& clip) {
  entry.integer("line", static_cast<std::int64_t>(line), static_cast<std::int64_t>(line));
  clip.name = entry.text("name");
  if (!plain_name(clip.name)) entry.fail("name", "\"" + clip.name + "\" is not a plain file name");
  const std::int64_t most = frames_told(tokenizer, clip.ids);
  clip.frames = entry.integer("frames", most - tokenizer.word_frames() + 1, most);
  const std::vector<double> start = entry.numbers("start");
  if (start.size() != 3) entry.fail("start", "expected three numbers");
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(start[i] >= -1e6 && start[i] <= 1e6)) entry.fail("start", "expected metres");
    clip.start[static_cast<Eigen::Index>(i)] = start[i];
  }
  JsonObject labels = entry.object("labels");
  for (const std::string& label : labels.keys()) clip.labels[label] = labels.text(label);
  entry.finish();
}

// Gives the clips of a corpus their names, labels and starts.
void read_index(const std::filesystem::path& path, const AnyTokenizer& tokenizer,
                std::vector<CorpusClip>& clips) {
  JsonObject object(load_json(path), path.string());
  object.choice("format", {kCorpusFormat});
  object.integer("version", 1, 1);
  const std::string fingerprint = object.text("tokenizer");
  if (fingerprint != tokenizer.fingerprint())
    object.fail("tokenizer", "the corpus was written by tokenizer " + fingerprint +
                                 ", this one is " + tokenizer.fingerprint() +
                                 "; decode with the tokenizer.json that lies beside it");
  const Json& lines = object.raw("clips");
  if (!lines.is_array() || lines.size() != clips.size())
    object.fail("clips", "expected one entry for each of the corpus's " +
                             std::to_string(clips.size()) +
                             " lines; if the text was edited, move this file away");
  object.finish();
  std::set<std::string> names;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    JsonObject entry(lines[i], path.string() + ": clip " + std::to_string(i + 1));
    read_index_entry(entry, i + 1, tokenizer, clips[i]);
    if (!names.insert(clips[i].name).second)
      entry.fail("name", "\"" + clips[i].name + "\" is there twice");
  }
}

}  // namespace

std::filesystem::path corpus_index_path(const std::filesystem::path& corpus) {
  return corpus.parent_path() / (corpus.stem().string() + ".clips.json");
}

std::string corpus_line(const AnyTokenizer& tokenizer, const std::vector<std::int32_t>& ids) {
  std::string text = tokenizer.to_text(ids);
  if (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::vector<std::int32_t> parse_corpus_line(const AnyTokenizer& tokenizer, const std::string& text,
                                            const std::string& file, std::size_t line) {
  if (text.empty()) throw DataError(at_line(file, line), "is empty, expected a clip");
  std::vector<std::int32_t> ids = tokenizer.from_text(text, file, line);
  if (ids.back() != Tokenizer::kSeparator) ids.push_back(Tokenizer::kSeparator);
  tokenizer.check(ids, to_string(at_line(file, line)));
  return ids;
}

void write_corpus(const std::filesystem::path& path, const AnyTokenizer& tokenizer,
                  const std::vector<CorpusClip>& clips) {
  std::string text;
  for (const CorpusClip& clip : clips) text += corpus_line(tokenizer, clip.ids) + "\n";
  write_file(path, text);
  save_json(corpus_index_path(path), index_json(tokenizer, clips));
}

std::vector<CorpusClip> read_corpus(const std::filesystem::path& path,
                                    const AnyTokenizer& tokenizer) {
  const std::string text = read_file(path);
  if (text.empty()) throw DataError(in_file(path.string()), "is empty, expected one clip a line");
  std::vector<CorpusClip> clips;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    CorpusClip clip;
    clip.name = "line_" + std::to_string(clips.size() + 1);
    clip.ids =
        parse_corpus_line(tokenizer, text.substr(at, end - at), path.string(), clips.size() + 1);
    clips.push_back(std::move(clip));
    at = end + 1;
  }
  const std::filesystem::path index = corpus_index_path(path);
  if (std::filesystem::exists(index)) read_index(index, tokenizer, clips);
  return clips;
}

}  // namespace mocaplm
