#include "train/setup.h"

#include "common/error.h"
#include "model/transformer/setup.h"
#include "motion/chosen_clips.h"
#include "train/balance.h"
#include "train/learn_pieces.h"
#include "train/stream_shape.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

Tokenizer fit_tokenizer(const TokenizerConfig& config, const Dataset& dataset) {
  const std::vector<DatasetEntry> entries = dataset.split("train");
  if (entries.empty())
    throw DataError(in_file(dataset.directory.string()), "the split \"train\" is empty");
  return Tokenizer::fit(config, entries.size(),
                        [&](std::size_t i) { return load_clip(dataset, entries[i]); });
}

// The labels that head each window: those asked for, or, when fine-tuning, all that the data has.
std::vector<std::string> chosen_conditions(const TrainOptions& options, const Dataset& dataset) {
  std::vector<std::string> chosen = options.config.train.conditions;
  if (chosen == std::vector<std::string>{"none"}) return {};
  if (chosen.empty()) return options.from ? dataset.label_names() : chosen;
  for (const std::string& label : chosen) check_label(dataset, label, "conditions");
  return chosen;
}

Tokenizer stored_tokenizer(const StoredModel& stored, const std::string& place) {
  return Tokenizer::of_model(stored.tokenizer, stored.description.tokenizer_fingerprint, place);
}

void use_stored_pieces(TrainSetup& setup, const StoredModel& stored, const std::string& place) {
  setup.piece_bytes = stored.pieces;
  setup.pieces = PieceVocabulary::of_model(stored.pieces, setup.tokenizer,
                                           stored.description.pieces_fingerprint, place);
  setup.config.pieces = {};
  if (setup.pieces.any())
    (setup.pieces.bpe() ? setup.config.pieces.bpe : setup.config.pieces.unigram) =
        setup.pieces.learnt();
}

void learn_own_pieces(TrainSetup& setup, const TrainOptions& options) {
  if (!setup.config.pieces.any()) return;
  setup.piece_bytes = learn_model_pieces(setup.config.pieces, setup.tokenizer, options.data,
                                         options.tokenize_program);
  setup.pieces = PieceVocabulary(setup.piece_bytes, setup.tokenizer, "the pieces just learnt");
  if (!setup.pieces.any())
    throw UsageError("pieces: " + std::to_string(setup.pieces.learnt()) +
                     " leave room for single characters only; the alphabet has " +
                     std::to_string(setup.tokenizer.bins()) + ": ask for more");
  setup.description.pieces_fingerprint = setup.pieces.fingerprint();
}

void add_condition_tokens(TrainSetup& setup, const TrainOptions& options) {
  setup.description.conditions = chosen_conditions(options, setup.dataset);
  for (const std::string& label : setup.description.conditions)
    setup.tokenizer.add_label_values(label, setup.dataset.label_values(label));
  setup.description.shape = stream_shape(setup.tokenizer, setup.pieces);
}

void start_fresh(TrainSetup& setup, const TrainOptions& options) {
  setup.tokenizer = fit_tokenizer(setup.config.tokenizer, setup.dataset);
  setup.description.config = setup.config.model;
  setup.description.tokenizer_fingerprint = setup.tokenizer.fingerprint();
  learn_own_pieces(setup, options);
  add_condition_tokens(setup, options);
  setup.model = make_language_model(setup.description);
}

// The stored model's own settings win over the config file's: its weights fit no others.
void start_from(TrainSetup& setup, const TrainOptions& options) {
  const std::string place = resolve_model(*options.from).string();
  const StoredModel stored = load_model(*options.from);
  load_transformer(stored,
                   place);  // reruns the self-test before anything is built on these weights
  setup.tokenizer = stored_tokenizer(stored, place);
  use_stored_pieces(setup, stored, place);
  setup.description = stored.description;
  setup.description.classes.clear();
  setup.description.class_frames = 0;
  const double dropout = setup.config.model.dropout;
  setup.config.tokenizer = setup.tokenizer.config();
  setup.config.model = stored.description.config;
  setup.config.model.dropout = setup.description.config.dropout = dropout;
  add_condition_tokens(setup, options);
  setup.model = make_language_model(setup.description);
  import_weights(*setup.model, language_tensors(stored.tensors), place + "/model.safetensors",
                 /*may_grow=*/true);
}

void start_again(TrainSetup& setup, const TrainOptions& options) {
  const std::string place = (options.out / "last").string();
  const StoredModel stored = load_model(place);
  setup.tokenizer = stored_tokenizer(stored, place);
  use_stored_pieces(setup, stored, place);
  setup.description = stored.description;
  setup.model = load_transformer(stored, place);
}

// Before pieces are learnt, which takes a while.
void check_pieces(const RunConfig& config) {
  if (!config.pieces.any()) return;
  if (config.pieces.bpe > 0 && config.pieces.unigram > 0)
    throw UsageError("pieces come from byte pair encoding (bpe) or from a unigram model: give one");
  if (config.model.architecture != "flat" || config.model.objective != "causal")
    throw UsageError("pieces (bpe, unigram) need architecture flat and objective causal");
}

}  // namespace

void balance_corpus(const TrainSetup& setup, Corpus& corpus) {
  const TrainConfig& config = setup.config.train;
  if (!config.balance.empty()) balance(corpus, config.balance, config.balance_share);
}

TrainSetup set_up_training(const TrainOptions& options) {
  TrainSetup setup;
  setup.config = options.config;
  check_pieces(setup.config);
  setup.dataset = load_dataset(options.data);
  if (const std::string& label = setup.config.train.balance; !label.empty())
    check_label(setup.dataset, label, "balance");
  at::manual_seed(static_cast<std::uint64_t>(setup.config.train.seed));
  if (options.resume)
    start_again(setup, options);
  else if (options.from)
    start_from(setup, options);
  else
    start_fresh(setup, options);
  if (setup.config.train.joint_subset > 0 && setup.pieces.any())
    throw UsageError("joint_subset needs tokens of single characters: leave out bpe and unigram");
  setup.description.procedural = setup.dataset.procedural;
  setup.train = encode_split(setup.dataset, "train", setup.encoding(), setup.config.train.mirror,
                             options.threads);
  balance_corpus(setup, setup.train);
  setup.validation =
      encode_split(setup.dataset, "validation", setup.encoding(), false, options.threads);
  if (const auto left_out = setup.train.left_out + setup.validation.left_out; left_out > 0)
    std::fprintf(stderr, "left out: %lld clips shorter than 3 frames\n",
                 static_cast<long long>(left_out));
  return setup;
}

}  // namespace mocaplm
