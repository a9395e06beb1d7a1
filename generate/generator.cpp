#include "generate/generator.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/skeleton.h"

namespace mocaplm {

namespace {

constexpr std::int32_t kFree = -1;

Tokenizer matching_tokenizer(const StoredModel& model, const std::string& place) {
  Tokenizer tokenizer =
      Tokenizer::of_model(model.tokenizer, model.description.tokenizer_fingerprint, place);
  const StreamShape& shape = model.description.shape;
  if (tokenizer.vocabulary() != shape.vocabulary || tokenizer.channels() != shape.channels ||
      tokenizer.bins() != shape.bins || Tokenizer::kFirstBin != shape.first_bin)
    throw DataError(in_file(place),
                    "tokenizer.json is not the tokenizer that this model was trained with");
  return tokenizer;
}

std::string joint_list(const std::vector<int>& joints) {
  std::vector<std::string> names;
  for (const int joint : joints) names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  return join(names, ", ");
}

// True for the channels that a prompt of these joints gives; the root's translation goes with the
// pelvis.
std::vector<bool> given_channels(const Tokenizer& tokenizer, const std::vector<int>& joints) {
  std::vector<bool> given;
  for (int c = 0; c < tokenizer.channels(); ++c) {
    const int joint =
        std::max(tokenizer.channel_joint(c), 0);  // -1, the translation, counts as the pelvis
    given.push_back(joints.empty() ||
                    std::find(joints.begin(), joints.end(), joint) != joints.end());
  }
  return given;
}

}  // namespace

struct Generator::Plan {
  std::size_t frames = 0;  // of the result
  std::size_t whole = 0;   // frames of a prompt that is continued
  std::vector<std::int32_t>
      given;    // one per token of the stream so far as the prompt reaches; kFree to fill in
  Clip prompt;  // at the tokenizer's rate
};

Generator::Generator(const StoredModel& model, const std::string& place)
    : engine_(model, place), tokenizer_(matching_tokenizer(model, place)) {}

std::vector<std::int32_t> Generator::prefix(const Labels& labels) const {
  const std::vector<std::string>& conditions = description().conditions;
  for (const auto& [name, value] : labels) {
    if (conditions.empty())
      throw DataError(in_file("--" + name),
                      "this model was trained without condition tokens; fine-tune it on labelled "
                      "clips (train --from)");
    if (std::find(conditions.begin(), conditions.end(), name) == conditions.end())
      throw DataError(in_file("--" + name),
                      "the model has no such condition" + known_names(name, conditions, "It has"));
  }
  std::vector<std::int32_t> tokens = {Tokenizer::kStart};
  for (const std::string& name : conditions) {
    const auto found = labels.find(name);
    tokens.push_back(found == labels.end() ? Tokenizer::kMask
                                           : tokenizer_.label_id(name, found->second));
  }
  return tokens;
}

Generator::Plan Generator::plan(const GenerateRequest& request, GenerateResult& result) const {
  Plan plan;
  const double fps = tokenizer_.config().fps;
  if (!std::isfinite(request.seconds) || request.seconds <= 0 || request.seconds > 3600)
    throw UsageError("--seconds " + format_number(request.seconds) +
                     ": expected more than 0 and at most 3600");
  plan.frames = static_cast<std::size_t>(std::max(1.0, std::round(request.seconds * fps)));
  if (!request.prompt) {
    if (!request.joints.empty())
      throw UsageError("--joints needs a --prompt whose joints are kept");
    return plan;
  }
  for (const int joint : request.joints) {
    const auto& modelled = tokenizer_.joints();
    if (std::find(modelled.begin(), modelled.end(), joint) != modelled.end())
      result.joints.push_back(joint);
  }
  if (!request.joints.empty() && result.joints.empty())
    throw UsageError("the model has none of the prompted joints; it has: " +
                     joint_list(tokenizer_.joints()));
  if (result.joints.size() < request.joints.size())
    result.notes.push_back("of the prompted joints the model has only: " +
                           joint_list(result.joints));
  if (!std::isfinite(request.prompt_seconds) || request.prompt_seconds < 0)
    throw UsageError("--prompt-seconds " + format_number(request.prompt_seconds) +
                     ": expected more than 0, or 0 for the whole prompt");
  plan.prompt = tokenizer_.at_rate(*request.prompt);
  if (std::abs(request.prompt->fps - fps) > 1e-9)
    result.notes.push_back("the prompt was resampled from " + format_number(request.prompt->fps) +
                           " to " + format_number(fps) + " frames per second");
  auto use = static_cast<std::size_t>(plan.prompt.frames());
  if (request.prompt_seconds > 0)
    use = std::min(
        use, static_cast<std::size_t>(std::max(1.0, std::round(request.prompt_seconds * fps))));
  const bool continues = request.joints.empty();
  if (continues) {
    plan.whole = use;
    plan.frames += use;  // what is asked for comes after the prompt
  } else if (use < plan.frames) {
    result.notes.push_back("the prompt lasts " + format_number(static_cast<double>(use) / fps) +
                           " s: after it the prompted joints move freely too");
  }
  use = std::min(use, plan.frames);
  plan.prompt = slice(plan.prompt, 0, static_cast<Eigen::Index>(use));
  plan.given = tokenizer_.encode(plan.prompt).ids;
  result.context_frozen = frozen_share(plan.given, tokenizer_);
  const std::vector<bool> channels = given_channels(tokenizer_, result.joints);
  const auto per_frame = static_cast<std::size_t>(tokenizer_.tokens_per_frame());
  for (std::size_t i = 0; i < plan.given.size(); ++i)
    if (i % per_frame < channels.size() && !channels[i % per_frame]) plan.given[i] = kFree;
  return plan;
}

// Past the context the older half of the frames is forgotten, whole frames at a time; the
// conditions stay.
void Generator::refill(const std::vector<std::int32_t>& prefix,
                       const std::vector<std::int32_t>& ids) {
  const auto per_frame = static_cast<std::size_t>(tokenizer_.tokens_per_frame());
  const std::size_t frames =
      (static_cast<std::size_t>(engine_.capacity()) - prefix.size()) / per_frame;
  const std::size_t done = ids.size() / per_frame;
  first_ = (done - std::min(done, frames / 2)) * per_frame;
  engine_.reset();
  engine_.feed_silently(window_input(description(), prefix, ids, first_, ids.size() - first_));
}

GenerateResult Generator::generate(const GenerateRequest& request,
                                   const std::function<void(std::size_t, std::size_t)>& progress) {
  GenerateResult result;
  const std::vector<std::int32_t> head = prefix(request.labels);
  const Plan plan = this->plan(request, result);
  const ModelDescription& model = description();
  const auto per_frame = static_cast<std::size_t>(tokenizer_.tokens_per_frame());
  Sampler sampler(request.sampling);
  std::vector<std::int32_t> ids;
  engine_.reset();
  first_ = 0;
  ModelInput pending = window_input(model, head, ids, 0, 0);
  while (ids.size() < plan.frames * per_frame) {
    const std::size_t at = ids.size(), channel = at % per_frame;
    std::int32_t next = kFree;
    if (channel + 1 == per_frame)
      next = Tokenizer::kSeparator;  // nowhere else, and nothing else here
    else if (at < plan.given.size())
      next = plan.given[at];
    if (next == kFree) {
      next = sampler.pick(engine_.feed(pending), Tokenizer::kFirstBin, tokenizer_.bins());
      pending = ModelInput();
    }
    ids.push_back(next);
    if (engine_.length() + static_cast<std::int64_t>(pending.size()) >= engine_.capacity()) {
      refill(head, std::vector<std::int32_t>(ids.begin(), ids.end() - 1));
      pending = ModelInput();
    }
    append_stream(pending, model, ids, first_, at);
    if (channel + 1 == per_frame && progress) progress(ids.size() / per_frame, plan.frames);
  }
  const Eigen::Vector3d start = plan.prompt.frames() > 0 ? Eigen::Vector3d(plan.prompt.trans.row(0))
                                                         : Eigen::Vector3d::Zero();
  result.frozen = frozen_share(ids, tokenizer_);
  result.clip = tokenizer_.decode(ids, "generated", start);
  result.clip.labels = request.labels;
  result.context = plan.prompt;
  // Prompted joints are kept as given, not as their bins.
  for (Eigen::Index t = 0; t < plan.prompt.frames(); ++t)
    for (const int joint : plan.whole > 0 ? tokenizer_.joints() : result.joints)
      result.clip.poses.row(t).segment<3>(3 * joint) =
          plan.prompt.poses.row(t).segment<3>(3 * joint);
  return result;
}

double frozen_share(const std::vector<std::int32_t>& ids, const Tokenizer& tokenizer) {
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  const std::size_t frames = ids.size() / per_frame;
  if (frames < 2) return 0;
  std::size_t frozen = 0;
  for (std::size_t t = 1; t < frames; ++t) {
    bool still = true;
    for (std::size_t c = 0; c < static_cast<std::size_t>(tokenizer.rotation_channels()) && still;
         ++c)
      still = std::abs(ids[t * per_frame + c] - ids[(t - 1) * per_frame + c]) <= 1;
    frozen += still ? 1 : 0;
  }
  return static_cast<double>(frozen) / static_cast<double>(frames - 1);
}

}  // namespace mocaplm
