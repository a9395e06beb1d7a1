#include "evaluate/evaluate.h"

#include <map>

#include "common/error.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/text.h"
#include "evaluate/likelihood.h"
#include "evaluate/masked_likelihood.h"
#include "generate/piece_decoder.h"
#include "model/transformer/setup.h"
#include "model/transformer/weights.h"
#include "motion/chosen_clips.h"
#include "motion/skeleton.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

std::string value_of(const DatasetEntry& entry, const std::string& label) {
  if (label.empty()) return "";
  const auto found = entry.labels.find(label);
  return found == entry.labels.end() ? "(none)" : found->second;
}

struct EncodedSplit {
  std::vector<DatasetEntry> entries;
  std::vector<ScoredClip> clips;
};

EncodedSplit encode(const Dataset& dataset, const EvaluateOptions& options,
                    const std::string& split, const Tokenizer& tokenizer,
                    const std::vector<std::string>& conditions,
                    const PieceVocabulary& pieces = {}) {
  EncodedSplit out;
  out.entries = chosen_entries(dataset, split, options.where);
  out.clips.resize(out.entries.size());
  parallel_for(out.entries.size(), options.threads, [&](std::size_t i) {
    const Clip clip = load_clip(dataset, out.entries[i]);
    out.clips[i].ids = tokenizer.encode(clip).ids;
    out.clips[i].prefix = pieces.ids(
        condition_prefix(tokenizer, conditions, options.conditions ? clip.labels : Labels()));
    if (pieces.any()) out.clips[i].pieces = pieces.encode(out.clips[i].ids);
  });
  return out;
}

Json per_frame(const BitCount& count, int first, int channels) {
  return count.per_frame(first, channels);
}

void add_row(Table& table, const std::string& name, const BitColumns& columns, int first,
             int channels) {
  std::vector<Json> cells = {name, channels, per_frame(columns.model, first, channels)};
  for (const BitCount& order : columns.orders) cells.push_back(per_frame(order, first, channels));
  table.row(cells);
}

constexpr const char* kMaskedNote =
    "a masked model: each token is hidden with a seventh of the others and told by the rest of its "
    "window, what comes after included; its bits compare with no causal model's, nor with the "
    "baselines'";

constexpr const char* kPiecesNote =
    "a model of pieces: each frame is told in the pieces that training cuts it into, one of "
    "several "
    "ways, so its bits are an upper bound; those of a piece are shared equally by its channels";

Table make_table(const std::string& title, const BitColumns& columns, const Tokenizer& tokenizer,
                 const ModelDescription& model) {
  Table table(title, {"bits/frame", "channels", "model", "order 0", "order 1", "order 2"});
  table.digits({-1, -1, 2, 2, 2, 2});
  const int channels = tokenizer.channels(), rotations = tokenizer.rotation_channels();
  add_row(table, "total", columns, 0, channels);
  add_row(table, "rotations", columns, 0, rotations);
  if (channels > rotations)
    add_row(table, "root translation", columns, rotations, channels - rotations);
  for (std::size_t j = 0; j < tokenizer.joints().size(); ++j)
    add_row(table, joint_names()[static_cast<std::size_t>(tokenizer.joints()[j])], columns,
            static_cast<int>(3 * j), 3);
  std::vector<Json> tokens = {"bits/token", 1, columns.model.per_frame(0, channels) / channels};
  for (const BitCount& order : columns.orders)
    tokens.push_back(order.per_frame(0, channels) / channels);
  table.row(tokens);
  table.note(model.masked() ? kMaskedNote
                            : "separators, which cost the model " +
                                  format_fixed(columns.model.per_frame(channels, 1), 4) +
                                  " bits/frame, are not counted");
  if (model.has_pieces()) table.note(kPiecesNote);
  table.note(std::to_string(columns.model.frames) + " frames at " +
             format_number(tokenizer.config().fps) + " per second");
  return table;
}

using Fitted = std::map<std::string, Baselines>;

// Baselines of each value of `by` in the training split. Every value of `test` must be among them:
// said before the long work of scoring.
Fitted fit_baselines(const EvaluateOptions& options, const EncodedSplit& train,
                     const EncodedSplit& test, const Tokenizer& tokenizer) {
  Fitted fitted;
  for (std::size_t i = 0; i < train.clips.size(); ++i)
    fitted
        .try_emplace(value_of(train.entries[i], options.by), tokenizer.channels(), tokenizer.bins())
        .first->second.add(stream_bins(tokenizer, train.clips[i].ids));
  for (const DatasetEntry& entry : test.entries)
    if (const std::string value = value_of(entry, options.by); fitted.count(value) == 0)
      throw DataError(in_file(options.data.string()),
                      "no training clip has " + options.by + " " + value + ", which " + entry.name +
                          " has: the baselines cannot be fitted for it");
  return fitted;
}

std::vector<BitCount> score(const EvaluateOptions& options, const StoredModel& stored,
                            const std::string& place, const std::vector<ScoredClip>& clips) {
  constexpr std::int64_t kAtOnce = 16;
  Progress bar("evaluate", 0, "windows");
  const auto done = [&](std::size_t windows, std::size_t) { bar.update(windows); };
  std::vector<BitCount> scores;
  if (!options.engine.empty()) {
    const auto decoder =
        make_decoder(stored, place, {named_precision(options.engine), options.threads, kAtOnce});
    scores = score_clips(*decoder, clips, done);
  } else {
    const auto model = load_transformer(stored, place);
    const at::Device device = choose_device(options.device);
    model->to(device);
    model->set_precision(choose_precision(options.precision, device));
    scores = (stored.description.masked() ? score_masked_clips(*model, clips, kAtOnce, done)
                                          : score_clips(*model, clips, kAtOnce, done));
  }
  bar.finish();
  return scores;
}

}  // namespace

SplitBits split_bits(const EvaluateOptions& options) {
  set_up_cpu(options.threads);
  const std::string place = resolve_model(options.model).string();
  const StoredModel stored = load_model(options.model);
  SplitBits bits;
  bits.model = stored.description;
  bits.tokenizer =
      Tokenizer::of_model(stored.tokenizer, stored.description.tokenizer_fingerprint, place);
  const Tokenizer& tokenizer = bits.tokenizer;

  if (bits.model.masked() && !options.engine.empty())
    throw UsageError("--engine: a masked model is scored by LibTorch alone");
  if (bits.model.has_pieces() && !options.engine.empty())
    throw UsageError("--engine: a model of pieces is scored by LibTorch alone");
  const PieceVocabulary pieces = stored_pieces(stored, place);
  const Dataset dataset = load_dataset(options.data);
  if (!options.by.empty()) check_label(dataset, options.by, "--by");
  const EncodedSplit train = encode(dataset, options, "train", tokenizer, {});
  const EncodedSplit test =
      encode(dataset, options, options.split, tokenizer, stored.description.conditions, pieces);
  const Fitted baselines = fit_baselines(options, train, test, tokenizer);

  const std::vector<BitCount> scores = score(options, stored, place, test.clips);
  for (std::size_t i = 0; i < test.clips.size(); ++i) {
    const std::string value = value_of(test.entries[i], options.by);
    BitColumns& columns = bits.groups[value];
    columns.model.add(scores[i]);
    for (int order = 0; order < Baselines::kOrders; ++order)
      columns.orders[static_cast<std::size_t>(order)].add(
          baselines.at(value).score(order, stream_bins(tokenizer, test.clips[i].ids)));
  }
  return bits;
}

std::vector<Table> evaluate_tables(const EvaluateOptions& options) {
  const SplitBits bits = split_bits(options);
  std::vector<Table> tables;
  for (const auto& [value, columns] : bits.groups)
    tables.push_back(make_table(
        "split " + options.split + (options.by.empty() ? "" : ", " + options.by + " " + value),
        columns, bits.tokenizer, bits.model));
  return tables;
}

}  // namespace mocaplm
