#include "generate/plan.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/text.h"
#include "motion/skeleton.h"
#include "tokenizer/conditions.h"

namespace mocaplm {

namespace {

std::string joint_list(const std::vector<int>& joints) {
  std::vector<std::string> names;
  for (const int joint : joints) names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  return join(names, ", ");
}

bool has(const std::vector<int>& joints, int joint) {
  return std::find(joints.begin(), joints.end(), joint) != joints.end();
}

// True for the channels that a prompt of these joints gives; the root's translation goes with the
// pelvis.
std::vector<bool> given_channels(const Tokenizer& tokenizer, const std::vector<int>& joints) {
  std::vector<bool> given;
  for (int c = 0; c < tokenizer.channels(); ++c)  // -1, the translation, counts as the pelvis
    given.push_back(joints.empty() || has(joints, std::max(tokenizer.channel_joint(c), 0)));
  return given;
}

void check_seconds(const GenerateRequest& request) {
  if (!std::isfinite(request.seconds) || request.seconds <= 0 || request.seconds > 3600)
    throw UsageError("--seconds " + format_number(request.seconds) +
                     ": expected more than 0 and at most 3600");
  if (!std::isfinite(request.prompt_seconds) || request.prompt_seconds < 0)
    throw UsageError("--prompt-seconds " + format_number(request.prompt_seconds) +
                     ": expected more than 0, or 0 for the whole prompt");
}

void choose_joints(const GenerateRequest& request, const Tokenizer& tokenizer, GeneratePlan& plan) {
  for (const int joint : request.joints)
    if (has(tokenizer.joints(), joint)) plan.joints.push_back(joint);
  if (!request.joints.empty() && plan.joints.empty())
    throw UsageError("the model has none of the prompted joints; it has: " +
                     joint_list(tokenizer.joints()));
  if (plan.joints.size() < request.joints.size())
    plan.notes.push_back("of the prompted joints the model has only: " + joint_list(plan.joints));
}

// Frames of the prompt that take part, and the length of the result.
Eigen::Index choose_frames(const GenerateRequest& request, double fps, GeneratePlan& plan) {
  auto use = static_cast<std::size_t>(plan.prompt.frames());
  if (request.prompt_seconds > 0)
    use = std::min(
        use, static_cast<std::size_t>(std::max(1.0, std::round(request.prompt_seconds * fps))));
  if (request.joints.empty()) {
    plan.frames += use;  // what is asked for comes after the prompt
  } else if (use < plan.frames) {
    plan.notes.push_back("the prompt lasts " + format_number(static_cast<double>(use) / fps) +
                         " s: after it the prompted joints move freely too");
  }
  return static_cast<Eigen::Index>(std::min(use, plan.frames));
}

}  // namespace

GeneratePlan plan_generation(const GenerateRequest& request, const Tokenizer& tokenizer) {
  GeneratePlan plan;
  const double fps = tokenizer.config().fps;
  check_seconds(request);
  plan.frames = static_cast<std::size_t>(std::max(1.0, std::round(request.seconds * fps)));
  if (!request.prompt) {
    if (!request.joints.empty())
      throw UsageError("--joints needs a --prompt whose joints are kept");
    return plan;
  }
  choose_joints(request, tokenizer, plan);
  plan.kept = request.joints.empty() ? tokenizer.joints() : plan.joints;
  plan.prompt = tokenizer.at_rate(*request.prompt);
  if (std::abs(request.prompt->fps - fps) > 1e-9)
    plan.notes.push_back("the prompt was resampled from " + format_number(request.prompt->fps) +
                         " to " + format_number(fps) + " frames per second");
  plan.prompt = slice(plan.prompt, 0, choose_frames(request, fps, plan));
  plan.given = tokenizer.encode(plan.prompt).ids;
  plan.prompt_frozen = frozen_share(plan.given, tokenizer);
  const std::vector<bool> channels = given_channels(tokenizer, plan.joints);
  const auto per_frame = static_cast<std::size_t>(tokenizer.tokens_per_frame());
  for (std::size_t i = 0; i < plan.given.size(); ++i)
    if (i % per_frame < channels.size() && !channels[i % per_frame]) plan.given[i] = kFree;
  return plan;
}

std::vector<std::int32_t> condition_prefix(const Labels& labels, const ModelDescription& model,
                                           const Tokenizer& tokenizer) {
  const std::vector<std::string>& conditions = model.conditions;
  for (const auto& [name, value] : labels) {
    if (conditions.empty())
      throw DataError(in_file("--" + name),
                      "this model was trained without condition tokens; fine-tune it on labelled "
                      "clips (train --from)");
    if (std::find(conditions.begin(), conditions.end(), name) == conditions.end())
      throw DataError(in_file("--" + name),
                      "the model has no such condition" + known_names(name, conditions, "It has"));
    tokenizer.label_id(name, value);  // refuses a value that it does not know
  }
  return condition_prefix(tokenizer, conditions, labels);
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
