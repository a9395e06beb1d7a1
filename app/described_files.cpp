#include <algorithm>
#include <map>
#include <system_error>

#include "app/between.h"
#include "app/described_parts.h"
#include "common/csv.h"
#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/formats.h"
#include "spectral/index.h"
#include "tokenizer/corpus.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string size_text(const std::string& bytes) {
  return format_fixed(static_cast<double>(bytes.size()) / 1e6, 2) + " MB";
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

}  // namespace

std::vector<Table> describe_page(const fs::path& file) {
  const std::string text = read_file(file);
  if (text.find("Written by mocaplm") == std::string::npos)
    throw DataError(in_file(file.string()), "is a page, but not one of this program's");
  Table table(file.string(), {"page", between(text, "<title>", "</title>")});
  table.row({"size", size_text(text)});
  table.row({"tables", count_of(text, "<table")});
  table.note("Open it in a browser; it needs nothing else.");
  return {table};
}

std::vector<Table> describe_picture(const fs::path& file) {
  const std::string text = read_file(file);
  if (text.find("<svg") == std::string::npos)
    throw DataError(in_file(file.string()), "has no <svg> element, so it is no picture");
  const std::string title = between(text, "<title>", "</title>");
  Table table(file.string(), {"picture (SVG)", title.empty() ? "plot" : title});
  table.row({"size", size_text(text)});
  return {table};
}

std::vector<Table> describe_corpus(const fs::path& file) {
  const std::string text = read_file(file);
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  const fs::path index = corpus_index_path(file), tokenizer = file.parent_path() / "tokenizer.json";
  if (!fs::exists(index))
    throw DataError(in_file(file.string()), "is a text; a corpus of this program has " +
                                                index.filename().string() + " beside it");
  Table table(file.string(), {"text corpus", "value"});
  table.row({"clips", lines});
  table.row({"words", count_of(text, " ") + lines});
  if (fs::exists(tokenizer)) {
    std::int64_t frames = 0;
    const auto own = load_tokenizer(tokenizer);
    for (const CorpusClip& clip : read_corpus(file, *own)) frames += clip.frames;
    if (frames > 0) table.row({"frames", frames});
    table.row({"tokenizer", tokenizer.string() + ", fingerprint " + own->fingerprint()});
  }
  table.note("mocaplm tokenize --decode brings the clips back.");
  return {table};
}

std::vector<Table> describe_recordings(const fs::path& folder) {
  constexpr int kMost = 100000;  // a whole disk would take minutes
  std::map<std::string, std::size_t> counts;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                         error);
  int seen = 0;
  for (; !error && entry != fs::recursive_directory_iterator() && seen < kMost;
       entry.increment(error), ++seen)
    if (entry->is_regular_file(error) && looks_like_motion(entry->path()))
      ++counts[lower(entry->path().extension().string())];
  if (counts.empty()) return {};
  Table table(folder.string(), {"folder of motion files", "files"});
  for (const auto& [ending, count] : counts) table.row({ending, count});
  if (seen == kMost) table.note("There is more: only 100,000 files and folders were looked at.");
  table.note("mocaplm import " + folder.string() + " --out data makes a dataset of them.");
  return {table};
}

std::vector<Table> describe_csv(const fs::path& file) {
  const Csv csv = read_csv(file);
  Table table(file.string(), {"table (CSV)", "value"});
  table.row({"columns", value_text(csv.columns)});
  table.row({"rows", csv.rows.size()});
  if (csv.find("time") >= 0) table.note("Trajectories over time: input of mocaplm gesture.");
  return {table};
}

std::vector<Table> describe_lines(const fs::path& file) {
  const std::vector<std::string> lines = split(read_file(file), '\n');
  const auto count = static_cast<std::int64_t>(
      std::count_if(lines.begin(), lines.end(), [](const auto& line) { return !line.empty(); }));
  const Json first = parse_json(lines[0], file.string());
  const bool frames = first.is_object() && first.contains("poses"),
             log = first.is_object() && first.contains("validation_loss");
  if (!frames && !log)
    throw DataError(
        at_line(file.string(), 1),
        "is JSON, but neither a frame (generate --stream) nor a line of a training log");
  Table table(file.string(), {frames ? "stream of frames" : "log of a training run", "value"});
  table.row({frames ? "frames" : "validations", count});
  if (log) {
    double best = number_of(first, "validation_bits_per_frame");
    for (const std::string& line : lines)
      if (!line.empty())
        best =
            std::min(best, number_of(parse_json(line, file.string()), "validation_bits_per_frame"));
    table.row({"best validation", format_fixed(best, 2) + " bits/frame"});
  }
  return {table};
}

std::vector<Table> describe_index(const fs::path& file) {
  const SpectralIndex index(file);
  Table table(file.string(), {"spectral index (query)", index.config().feature});
  table.row({"windows", index.size()});
  table.row({"clips", index.clips().size()});
  table.row({"clips shorter than a window", index.clips_too_short()});
  table.row({"features", index.dimensions()});
  const Json settings = settings_json(index.config());
  for (const auto& item : settings.items())
    if (item.key() != "feature")
      table.row({item.key(), item.value().is_array() ? Json(item.value().dump()) : item.value()});
  return {table};
}

}  // namespace mocaplm
