#include "generate/dance.h"

#include <algorithm>

namespace mocaplm {

DanceInMaking::DanceInMaking(std::size_t index, const GenerateRequest& request, Engine& engine,
                             const Tokenizer& tokenizer, const Generator::OnFrame& on_frame)
    : index_(index),
      labels_(request.labels),
      engine_(engine),
      tokenizer_(tokenizer),
      on_frame_(on_frame),
      plan_(plan_generation(request, tokenizer)),
      prefix_(condition_prefix(request.labels, engine.description(), tokenizer)),
      sampler_(request.sampling),
      per_frame_(static_cast<std::size_t>(tokenizer.tokens_per_frame())) {}

void DanceInMaking::begin(std::int64_t sequence) {
  sequence_ = sequence;
  engine_.reset(sequence);
  pending_ = window_input(engine_.description(), prefix_, ids_, 0, 0);
}

std::int32_t DanceInMaking::known() const {
  const std::size_t at = ids_.size();
  if (at % per_frame_ + 1 == per_frame_)
    return Tokenizer::kSeparator;  // nowhere else, and nothing else here
  return at < plan_.given.size() ? plan_.given[at] : kFree;
}

void DanceInMaking::advance() {
  while (!done()) {
    const std::int32_t next = known();
    if (next == kFree) return;
    push(next);
  }
}

void DanceInMaking::choose(const std::vector<float>& logits) {
  const std::int32_t id = sampler_.pick(logits, Tokenizer::kFirstBin, tokenizer_.bins());
  pending_ = ModelInput();
  push(id);
}

void DanceInMaking::push(std::int32_t id) {
  ids_.push_back(id);
  const auto waiting = static_cast<std::int64_t>(pending_.size());
  if (engine_.length(sequence_) + waiting >= engine_.capacity()) slide();
  append_stream(pending_, engine_.description(), ids_, first_, ids_.size() - 1);
  if (ids_.size() % per_frame_ == 0 && on_frame_) tell_frame();
}

// Past the context the older half of the frames is forgotten, whole frames at a time; the
// conditions stay.
void DanceInMaking::slide() {
  const std::vector<std::int32_t> before(ids_.begin(), ids_.end() - 1);
  const std::size_t frames =
      (static_cast<std::size_t>(engine_.capacity()) - prefix_.size()) / per_frame_;
  const std::size_t done = before.size() / per_frame_;
  first_ = (done - std::min(done, frames / 2)) * per_frame_;
  const ModelInput window =
      window_input(engine_.description(), prefix_, before, first_, before.size() - first_);
  engine_.reset(sequence_);
  engine_.feed_silently({{sequence_, &window}});
  pending_ = ModelInput();
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
