#include "generate/dance.h"

#include <algorithm>
#include <numeric>

namespace mocaplm {

namespace {

// The stream's order, or with those channels first that the prompt gives in its first frame.
std::vector<int> decoding_order(const GeneratePlan& plan, const Decoder& decoder) {
  std::vector<int> order(static_cast<std::size_t>(decoder.description().shape.channels));
  std::iota(order.begin(), order.end(), 0);
  if (decoder.any_order() && plan.given.size() >= order.size())
    std::stable_partition(order.begin(), order.end(), [&](int channel) {
      return plan.given[static_cast<std::size_t>(channel)] != kFree;
    });
  return order;
}

}  // namespace

DanceInMaking::DanceInMaking(std::size_t index, const GenerateRequest& request, Decoder& decoder,
                             const Tokenizer& tokenizer, const PieceVocabulary& pieces,
                             const Generator::OnFrame& on_frame)
    : index_(index),
      labels_(request.labels),
      decoder_(decoder),
      tokenizer_(tokenizer),
      pieces_(pieces),
      on_frame_(on_frame),
      plan_(plan_generation(request, tokenizer)),
      prefix_(pieces.ids(condition_prefix(request.labels, decoder.description(), tokenizer))),
      sampler_(request.sampling),
      per_frame_(static_cast<std::size_t>(tokenizer.tokens_per_frame())),
      order_(decoding_order(plan_, decoder)),
      frame_(order_.size()) {}

void DanceInMaking::begin(std::int64_t sequence) {
  sequence_ = sequence;
  decoder_.begin(sequence, prefix_, {});
  if (decoder_.any_order()) decoder_.set_order(sequence, order_);
}

std::int32_t DanceInMaking::known() const {
  const std::size_t at = ids_.size() + static_cast<std::size_t>(order_[place_]);
  return at < plan_.given.size() ? plan_.given[at] : kFree;
}

void DanceInMaking::advance() {
  if (pieces_.any()) {
    while (!done() && place_ == 0 && push_known_frame()) {
    }
    return;
  }
  while (!done()) {
    const std::int32_t next = known();
    if (next == kFree) return;
    push(next);
  }
}

bool DanceInMaking::push_known_frame() {
  const std::size_t at = ids_.size();
  const auto begin = plan_.given.begin() + static_cast<std::ptrdiff_t>(at);
  if (at + per_frame_ > plan_.given.size() ||
      std::find(begin, begin + static_cast<std::ptrdiff_t>(per_frame_), kFree) !=
          begin + static_cast<std::ptrdiff_t>(per_frame_))
    return false;
  std::vector<std::int32_t> tokens;
  pieces_.encode_frame(plan_.given.data() + at, tokens);
  for (const std::int32_t token : tokens)
    if (token != Tokenizer::kSeparator) push_piece(token);  // which end_frame tells
  return true;
}

void DanceInMaking::find_allowed() {
  allowed_.clear();
  const std::size_t at = ids_.size() + place_;
  for (std::int32_t token = Tokenizer::kSeparator; token < pieces_.end(); ++token) {
    if (!pieces_.fits(token, static_cast<int>(place_))) continue;
    const PieceVocabulary::Characters characters = pieces_.characters(token);
    bool agrees = true;
    for (std::size_t i = 0; i < characters.size && at + i < plan_.given.size(); ++i)
      agrees = agrees && (plan_.given[at + i] == kFree || plan_.given[at + i] == characters[i]);
    if (agrees) allowed_.push_back(token);
  }
}

void DanceInMaking::choose(const std::vector<float>& logits) {
  if (pieces_.any()) {
    find_allowed();
    push_piece(sampler_.pick(logits, allowed_));
    return;
  }
  push(sampler_.pick(logits, Tokenizer::kFirstBin, tokenizer_.bins()));
}

void DanceInMaking::push(std::int32_t id) {
  decoder_.push(sequence_, id);
  frame_[static_cast<std::size_t>(order_[place_])] = id;
  if (++place_ == order_.size()) end_frame();
}

void DanceInMaking::push_piece(std::int32_t id) {
  decoder_.push(sequence_, id);
  const PieceVocabulary::Characters characters = pieces_.characters(id);
  const bool ends = characters.last() == Tokenizer::kSeparator;
  for (std::size_t i = 0; i + (ends ? 1 : 0) < characters.size; ++i)
    frame_[place_++] = characters[i];
  if (place_ == order_.size()) end_frame(ends);
}

void DanceInMaking::end_frame(bool told) {
  ids_.insert(ids_.end(), frame_.begin(), frame_.end());
  ids_.push_back(Tokenizer::kSeparator);  // nowhere else, and nothing else here
  place_ = 0;
  // Behind the last frame nothing comes.
  if (!done() && !told) decoder_.push(sequence_, Tokenizer::kSeparator);
  if (on_frame_) tell_frame();
}

// The last frame, standing where the one before leaves it.
void DanceInMaking::tell_frame() {
  const std::size_t frame = ids_.size() / per_frame_ - 1;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  if (!path_.empty())
    start = path_.back();
  else if (plan_.prompt.frames() > 0)
    start = plan_.prompt.trans.row(0).transpose();
  const std::vector<std::int32_t> tokens(ids_.end() - static_cast<std::ptrdiff_t>(per_frame_),
                                         ids_.end());
  GeneratedFrame told{index_, frame, plan_.frames, tokenizer_.decode(tokens, "generated", start)};
  path_.emplace_back(told.pose.trans.row(0).transpose());
  if (static_cast<Eigen::Index>(frame) < plan_.prompt.frames())
    for (const int joint : plan_.kept)
      told.pose.poses.row(0).segment<3>(3 * joint) =
          plan_.prompt.poses.row(static_cast<Eigen::Index>(frame)).segment<3>(3 * joint);
  on_frame_(told);
}

GenerateResult DanceInMaking::result() const {
  GenerateResult result;
  const Eigen::Vector3d start = plan_.prompt.frames() > 0
                                    ? Eigen::Vector3d(plan_.prompt.trans.row(0))
                                    : Eigen::Vector3d::Zero();
  result.clip = tokenizer_.decode(ids_, "generated", start);
  result.clip.labels = labels_;
  result.context = plan_.prompt;
  result.joints = plan_.joints;
  result.notes = plan_.notes;
  result.frozen = frozen_share(ids_, tokenizer_);
  result.context_frozen = plan_.prompt_frozen;
  // Prompted joints are kept as given, not as their bins.
  for (Eigen::Index t = 0; t < plan_.prompt.frames(); ++t)
    for (const int joint : plan_.kept)
      result.clip.poses.row(t).segment<3>(3 * joint) =
          plan_.prompt.poses.row(t).segment<3>(3 * joint);
  return result;
}

}  // namespace mocaplm
