#include "tokenizer/tokenize.h"

#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "common/error.h"
#include "common/progress.h"
#include "common/text.h"
#include "motion/formats/npz.h"
#include "motion/inputs.h"
#include "tokenizer/corpus.h"
#include "tokenizer/measure.h"

namespace mocaplm {

namespace {

namespace fs = std::filesystem;

// A clip that is read when it is needed: a large collection never lies in memory as a whole.
struct Source {
  std::string name;
  bool fit = true;  // part of what the tokenizer is fitted on
  bool test = false;
  std::function<Clip()> read;
};

// The training split of a dataset is fitted on; where it has none, and of files, all.
Source source_of(const MotionInput& input, const MotionReading& reading) {
  Source source{input.name, true, false,
                [input, reading] { return read_motion(input, reading).clip; }};
  if (input.dataset && !input.dataset->split("train").empty()) {
    const std::string split = input.entry()->split;
    source.fit = split == "train";
    source.test = split == "test";
  }
  return source;
}

std::vector<Source> open_inputs(const TokenizeOptions& options) {
  std::vector<Source> sources;
  for (const MotionInput& input : find_motions(options.inputs, {}, options.read))
    for (const MotionInput& part : parts_of(input, options.read))
      sources.push_back(source_of(part, options.read));
  if (sources.empty()) throw UsageError("there are no clips to tokenize");
  std::set<std::string> names;
  for (const Source& source : sources)
    if (!names.insert(source.name).second)
      throw UsageError("two clips are named \"" + source.name +
                       "\"; rename one of them or import them into one dataset");
  return sources;
}

std::unique_ptr<AnyTokenizer> make_tokenizer(const TokenizeOptions& options,
                                             const std::vector<Source>& sources) {
  if (!options.tokenizer.empty()) return load_tokenizer(options.tokenizer);
  std::vector<const Source*> fitted;
  for (const Source& source : sources)
    if (source.fit) fitted.push_back(&source);
  Progress progress("fit", fitted.size(), "clips");
  return fit_tokenizer(options.config, options.tiles, fitted.size(), [&](std::size_t i) {
    progress.update(i);
    return fitted[i]->read();
  });
}

// Pieces of the text of what the tokenizer is fitted on.
Pieces learn(const PieceConfig& config, const AnyTokenizer& tokenizer,
             const std::vector<Source>& sources) {
  std::vector<const Source*> fitted;
  for (const Source& source : sources)
    if (source.fit) fitted.push_back(&source);
  return learn_pieces(config, tokenizer, fitted.size(),
                      [&](std::size_t i) { return fitted[i]->read(); });
}

// An output folder may be a model's: its tokenizer (and the condition tokens in it) is never
// replaced.
bool write_tokenizer(const AnyTokenizer& tokenizer, const fs::path& path, bool write) {
  if (fs::exists(path)) {
    const std::string there = load_tokenizer(path)->fingerprint();
    if (there != tokenizer.fingerprint())
      throw DataError(in_file(path.string()), "is another tokenizer (" + there + ", not " +
                                                  tokenizer.fingerprint() +
                                                  "); give another --out or move it away");
    return true;
  }
  if (write) save_json(path, tokenizer.to_json());
  return false;
}

void check_text_target(const fs::path& corpus) {
  if (fs::exists(corpus) && !fs::exists(corpus_index_path(corpus)))
    throw DataError(in_file(corpus.string()),
                    "exists and was not written by tokenize; give another --out");
}

std::string clips_text(const std::vector<Clip>& clips) {
  double seconds = 0;
  for (const Clip& clip : clips) seconds += clip.seconds();
  return std::to_string(clips.size()) + " clips (" + format_duration(seconds) + ")";
}

// What encoding lost, in the table of either kind of tokenizer.
class Losses {
 public:
  explicit Losses(const AnyTokenizer& tokenizer)
      : tokenizer_(tokenizer),
        frames_(dynamic_cast<const FrameWords*>(&tokenizer)),
        words_(start_measure(tokenizer)) {}
  // The clip's line of a corpus; where it is in the motion is not needed there.
  CorpusClip encode(const std::string& name, const Clip& clip) {
    const std::int64_t before = words_.frames;
    TokenStream stream = frames_ ? encode_and_measure(frames_->tokenizer(), clip, loss_)
                                 : measure_clip(tokenizer_, clip, words_);
    return {name, clip.labels, clip.trans.row(0).transpose(), std::move(stream.ids),
            words_.frames - before};
  }
  Table table() const {
    return frames_
               ? loss_.table(frames_->tokenizer())
               : word_table(words_,
                            "Tiles of " + std::to_string(tokenizer_.word_frames()) + " frames, " +
                                format_number(tokenizer_.frames().fps) + " frames per second",
                            tokenizer_.fingerprint());
  }

 private:
  const AnyTokenizer& tokenizer_;
  const FrameWords* frames_;
  TokenizerLoss loss_;
  WordMeasure words_;
};

}  // namespace

Table tokenize(const TokenizeOptions& options) {
  const bool to_file = lower(options.out.extension().string()) == ".json";
  if ((options.text || options.pieces.any()) && to_file)
    throw UsageError("a text or pieces need a folder for --out, " + options.out.string() +
                     " is a .json file");
  const std::vector<Source> sources = open_inputs(options);
  const std::unique_ptr<AnyTokenizer> tokenizer = make_tokenizer(options, sources);
  const fs::path target = to_file ? options.out : options.out / "tokenizer.json";
  const fs::path corpus = options.out / "corpus.txt";
  write_tokenizer(*tokenizer, target, false);
  if (options.text) check_text_target(corpus);

  std::optional<Pieces> pieces;
  if (options.pieces.any()) pieces = learn(options.pieces, *tokenizer, sources);
  std::size_t tokens = 0;
  Losses losses(*tokenizer);
  std::vector<CorpusClip> clips;
  Progress progress("tokenize", sources.size(), "clips");
  for (const Source& source : sources) {
    CorpusClip line = losses.encode(source.name, source.read());
    if (pieces) tokens += pieces->encode(tokenizer->to_text(line.ids)).size();
    if (options.text) clips.push_back(std::move(line));
    progress.add(source.name);
  }
  progress.finish();
  Table table = losses.table();
  table.note(target.string() + (write_tokenizer(*tokenizer, target, true)
                                    ? ": the same tokenizer was there"
                                    : ": written"));
  if (pieces) {
    table.row({"pieces", pieces->size(), ""});
    table.row({"tokens as pieces", tokens, "with separators"});
    pieces->save(options.out / "pieces.model");
    table.note((options.out / "pieces.model").string() + ": written");
  }
  if (options.text) {
    write_corpus(corpus, *tokenizer, clips);
    table.note(corpus.string() + ": one clip a line, " +
               corpus_index_path(corpus).filename().string() + " names them");
  }
  return table;
}

std::vector<ReportRow> tokenize_report(const TokenizeOptions& options,
                                       const std::vector<std::string>& specs, std::string& note) {
  const std::vector<ReportSetting> settings =
      report_settings(specs, {"", options.config, options.tiles, options.pieces});
  std::vector<Clip> fitted, held_out;
  const std::vector<Source> sources = open_inputs(options);
  Progress progress("read", sources.size(), "clips");
  for (const Source& source : sources) {
    if (source.fit) fitted.push_back(source.read());
    if (source.test) held_out.push_back(source.read());
    progress.add(source.name);
  }
  progress.finish();
  const bool own = held_out.empty();
  note =
      "fitted on " + clips_text(fitted) + ", measured on " +
      (own ? "the same clips: there is no test split" : clips_text(held_out) + " not among them");
  return report(settings, fitted, own ? fitted : held_out);
}

Table untokenize(const fs::path& corpus, const fs::path& tokenizer_file, const fs::path& out) {
  const std::unique_ptr<AnyTokenizer> tokenizer = load_tokenizer(tokenizer_file);
  const std::vector<CorpusClip> lines = read_corpus(corpus, *tokenizer);
  for (const CorpusClip& line : lines)
    if (fs::exists(out / (line.name + ".npz")))
      throw DataError(in_file((out / (line.name + ".npz")).string()),
                      "exists already and is not replaced; give another --out");
  Table table("Decoded with tokenizer " + tokenizer->fingerprint(), {"clip", "frames", "seconds"});
  table.digits({-1, 0, 2});
  for (const CorpusClip& line : lines) {
    const Clip clip = tokenizer->decode(line.ids, line.frames, line.name, line.start);
    write_npz(out / (line.name + ".npz"), clip);
    table.row({line.name, clip.frames(), clip.seconds()});
  }
  return table;
}

}  // namespace mocaplm
