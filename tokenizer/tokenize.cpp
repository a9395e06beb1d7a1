#include "tokenizer/tokenize.h"

#include <functional>
#include <memory>
#include <set>

#include "common/error.h"
#include "common/progress.h"
#include "common/text.h"
#include "motion/dataset.h"
#include "motion/formats/formats.h"
#include "motion/formats/npz.h"
#include "tokenizer/corpus.h"
#include "tokenizer/measure.h"

namespace mocaplm {

namespace {

namespace fs = std::filesystem;

// A clip that is read when it is needed: a large collection never lies in memory as a whole.
struct Source {
  std::string name;
  bool fit = true;  // part of what the ranges are fitted on
  std::function<Clip()> read;
};

void add_dataset(const std::string& folder, std::vector<Source>& sources) {
  const auto dataset = std::make_shared<Dataset>(load_dataset(folder));
  const bool has_training = !dataset->split("train").empty();
  for (const DatasetEntry& entry : dataset->entries)
    sources.push_back({entry.name, !has_training || entry.split == "train",
                       [dataset, entry] { return load_clip(*dataset, entry); }});
}

std::vector<Source> open_inputs(const std::vector<std::string>& inputs) {
  std::vector<Source> sources;
  for (const std::string& input : inputs) {
    if (fs::is_directory(input))
      add_dataset(input, sources);
    else
      sources.push_back(
          {fs::path(input).stem().string(), true, [input] { return read_clip(input); }});
  }
  if (sources.empty()) throw UsageError("there are no clips to tokenize");
  std::set<std::string> names;
  for (const Source& source : sources)
    if (!names.insert(source.name).second)
      throw UsageError("two clips are named \"" + source.name +
                       "\"; rename one of them or import them into one dataset");
  return sources;
}

Tokenizer make_tokenizer(const TokenizeOptions& options, const std::vector<Source>& sources) {
  if (!options.tokenizer.empty()) return Tokenizer::load(options.tokenizer);
  std::vector<const Source*> fitted;
  for (const Source& source : sources)
    if (source.fit) fitted.push_back(&source);
  Progress progress("fit", fitted.size(), "clips");
  return Tokenizer::fit(options.config, fitted.size(), [&](std::size_t i) {
    progress.update(i);
    return fitted[i]->read();
  });
}

// An output folder may be a model's: its tokenizer (and the condition tokens in it) is never
// replaced.
bool write_tokenizer(const Tokenizer& tokenizer, const fs::path& path, bool write) {
  if (fs::exists(path)) {
    const std::string there = Tokenizer::load(path).fingerprint();
    if (there != tokenizer.fingerprint())
      throw DataError(in_file(path.string()), "is another tokenizer (" + there + ", not " +
                                                  tokenizer.fingerprint() +
                                                  "); give another --out or move it away");
    return true;
  }
  if (write) tokenizer.save(path);
  return false;
}

void check_text_target(const fs::path& corpus) {
  if (fs::exists(corpus) && !fs::exists(corpus_index_path(corpus)))
    throw DataError(in_file(corpus.string()),
                    "exists and was not written by tokenize; give another --out");
}

}  // namespace

Table tokenize(const TokenizeOptions& options) {
  const bool to_file = lower(options.out.extension().string()) == ".json";
  if (options.text && to_file)
    throw UsageError("--text needs a folder for --out, " + options.out.string() +
                     " is a .json file");
  const std::vector<Source> sources = open_inputs(options.inputs);
  const Tokenizer tokenizer = make_tokenizer(options, sources);
  const fs::path target = to_file ? options.out : options.out / "tokenizer.json";
  const fs::path corpus = options.out / "corpus.txt";
  write_tokenizer(tokenizer, target, false);
  if (options.text) check_text_target(corpus);

  TokenizerLoss loss;
  std::vector<CorpusClip> clips;
  Progress progress("tokenize", sources.size(), "clips");
  for (const Source& source : sources) {
    const Clip clip = source.read();
    TokenStream stream = encode_and_measure(tokenizer, clip, loss);
    if (options.text)
      clips.push_back(
          {source.name, clip.labels, clip.trans.row(0).transpose(), std::move(stream.ids)});
    progress.add(source.name);
  }
  progress.finish();
  Table table = loss.table(tokenizer);
  table.note(target.string() + (write_tokenizer(tokenizer, target, true)
                                    ? ": the same tokenizer was there"
                                    : ": written"));
  if (options.text) {
    write_corpus(corpus, tokenizer, clips);
    table.note(corpus.string() + ": one clip a line, " +
               corpus_index_path(corpus).filename().string() + " names them");
  }
  return table;
}

Table untokenize(const fs::path& corpus, const fs::path& tokenizer_file, const fs::path& out) {
  const Tokenizer tokenizer = Tokenizer::load(tokenizer_file);
  const std::vector<CorpusClip> lines = read_corpus(corpus, tokenizer);
  for (const CorpusClip& line : lines)
    if (fs::exists(out / (line.name + ".npz")))
      throw DataError(in_file((out / (line.name + ".npz")).string()),
                      "exists already and is not replaced; give another --out");
  Table table("Decoded with tokenizer " + tokenizer.fingerprint(), {"clip", "frames", "seconds"});
  table.digits({-1, 0, 2});
  for (const CorpusClip& line : lines) {
    const Clip clip = tokenizer.decode(line.ids, line.name, line.start);
    write_npz(out / (line.name + ".npz"), clip);
    table.row({line.name, clip.frames(), clip.seconds()});
  }
  return table;
}

}  // namespace mocaplm
