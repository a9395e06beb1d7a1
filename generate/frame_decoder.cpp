#include "generate/frame_decoder.h"

#include <algorithm>
#include <cassert>

#include "common/error.h"
#include "generate/tables.h"
#include "model/input.h"

namespace mocaplm {

namespace {

std::int64_t feature_count(const ModelDescription& d) {
  return d.shape.channels * kFrameFeatures;
}

EngineOptions a_sequence_a_joint(EngineOptions options, const ModelDescription& d) {
  options.sequences *= d.shape.channels / kJointChannels;
  return options;
}

}  // namespace

FrameDecoder::TimeTables::TimeTables(Weights& weights, const ModelDescription& d)
    : token(weights.take("token_embedding", {d.shape.vocabulary, d.config.n_embd})),
      position(weights.take("position_embedding", {d.config.block_size, d.config.n_embd})) {}

FrameDecoder::JointTables::JointTables(Weights& weights, const ModelDescription& d) {
  const std::int64_t width = d.config.decoder_embd, joints = d.shape.channels / kJointChannels,
                     rows = 1 + kJointChannels * model_sizes(d).history_rows;
  joint = weights.take("joint.embedding", {joints, width});
  time = weights.take("joint.time_embedding", {d.config.block_size, width});
  before = weights.take("joint.before_embedding", {joints + 1, width});
  chosen = weights.take("joint.chosen_embedding", {1 + kJointChannels * d.shape.bins, width});
  if (!d.config.history) return;
  surprise = weights.take("joint.surprise_embedding", {rows, width});
}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options)
    : FrameDecoder(model, place, options, language_tensors(model.tensors)) {}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options, const TensorMap& tensors)
    : FrameDecoder(model, place, options, Weights(tensors, place + "/model.safetensors")) {}

FrameDecoder::FrameDecoder(const StoredModel& model, const std::string& place,
                           const EngineOptions& options, Weights&& weights)
    : description_(model.description),
      options_(checked(options)),
      team_(options.threads),
      time_tables_(weights, description_),
      frame_in_(packed(weights, "frame_in", description_.config.n_embd, feature_count(description_),
                       options.precision, arena_)),
      time_(weights,
            {"block.", "ln", description_.config.n_layer, description_.config.n_head,
             description_.config.n_embd, description_.config.block_size},
            options_, team_, arena_),
      joint_in_(packed(weights, "joint_in", joints() * description_.config.decoder_embd,
                       description_.config.n_embd + feature_count(description_), options.precision,
                       arena_)),
      own_in_(packed(weights, "joint.own_in", description_.config.decoder_embd,
                     kJointChannels * kFrameFeatures, options.precision, arena_)),
      tables_(weights, description_),
      memory_(
          weights,
          {"joint.memory.", "", description_.config.memory_layer, description_.config.decoder_head,
           description_.config.decoder_embd, description_.config.block_size},
          a_sequence_a_joint(options_, description_), team_, arena_),
      joints_(weights,
              {"joint.decoder.", "", description_.config.decoder_layer,
               description_.config.decoder_head, description_.config.decoder_embd, joints()},
              options_, team_, arena_),
      channels_(weights, description_, options_, team_, arena_),
      streams_(static_cast<std::size_t>(options_.sequences)) {
  weights.finish();
  time_.followed_by(&joint_in_);
  const std::int64_t wide = description_.config.n_embd, features = feature_count(description_),
                     narrow = description_.config.decoder_embd;
  scratch_.assign(static_cast<std::size_t>(team_.size()), LinearScratch(wide + features));
  features_ = room(kMaxRows, features);
  embedded_ = room(kMaxRows, wide);
  states_ = room(kMaxRows, wide + features);
  own_ = room(kMaxRows, joint_in_.out());
  last_ = room(options_.sequences, narrow);
  check(model, place);
}

// The stored windows begin where their clips do, or are long enough that this does not matter.
void FrameDecoder::check(const StoredModel& model, const std::string& place) {
  const std::string file = place + "/selftest.json";
  for (const SelfTestCase& one : model.self_test) {
    check_input(one.input, description_, file);
    const auto frame = std::find_if(one.input.frame.begin(), one.input.frame.end(),
                                    [](std::int32_t f) { return f != 0; });
    const auto prefix = one.input.token.begin() + (frame - one.input.frame.begin());
    begin(0, {one.input.token.begin(), prefix}, {});
    for (auto id = prefix; id != one.input.token.end(); ++id) push(0, *id);
    if (at(0).frame_full()) throw DataError(in_file(file), "a window ends where no bin can follow");
    check_self_test(one, logits({0})[0], file, rounding_tolerance(options_.precision));
  }
}

void FrameDecoder::begin(std::int64_t sequence, const std::vector<std::int32_t>& prefix,
                         const std::vector<std::int32_t>& before) {
  at(sequence) = FrameStreamState(description_, prefix, before);
  reset_past(sequence);
  joints_.reset(sequence);
}

void FrameDecoder::set_order(std::int64_t sequence, const std::vector<int>& channels) {
  at(sequence).set_order(channels);
}

void FrameDecoder::push(std::int64_t sequence, std::int32_t id) {
  FrameStreamState& stream = at(sequence);
  if (!stream.frame_full()) {
    stream.choose(id - static_cast<std::int32_t>(description_.shape.first_bin));
    return;
  }
  stream.end_frame();
  joints_.reset(sequence);
  const std::int64_t most = time_.capacity() - static_cast<std::int64_t>(stream.prefix().size());
  if (stream.frames() <= most) return;
  stream.keep(most / 2);
  reset_past(sequence);
}

void FrameDecoder::reset_past(std::int64_t sequence) {
  time_.reset(sequence);
  for (std::int64_t j = 0; j < joints(); ++j) memory_.reset(sequence * joints() + j);
  at(sequence).prefix_fed = false;
  at(sequence).fed = 0;
}

const std::vector<std::vector<float>>& FrameDecoder::logits(const Sequences& sequences) {
  catch_up(sequences);
  run_joints(sequences);
  std::vector<FrameStreamState*> streams;
  for (const std::int64_t s : sequences) streams.push_back(&at(s));
  return channels_.logits(streams);
}

}  // namespace mocaplm
