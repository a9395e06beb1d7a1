#include "app/generated.h"

#include <filesystem>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/formats.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string conditions_text(const Labels& labels) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : labels) parts.push_back(name + " " + value);
  return parts.empty() ? "no conditions" : join(parts, ", ");
}

std::string joints_text(const std::vector<int>& joints) {
  std::vector<std::string> names;
  for (const int joint : joints) names.push_back(joint_names()[static_cast<std::size_t>(joint)]);
  return names.empty() ? "none" : join(names, ", ");
}

}  // namespace

Page generated_page(const Generator& generator, const GenerateRequest& request,
                    const GenerateResult& result, const std::string& model,
                    const std::string& prompt) {
  Page page;
  page.title = "A generated dance";
  page.highlight_name = "prompted joints";
  if (generator.description().procedural)
    page.note = "trained on procedural dances made by this program, not on motion capture";
  if (result.context.frames() > 0)
    page.motions.push_back(
        {"context", result.context, result.joints, {}, "The prompt: " + result.context.name});
  page.motions.push_back({"generated",
                          result.clip,
                          result.joints,
                          {},
                          "Generated with " + conditions_text(request.labels)});
  const SamplingConfig& s = request.sampling;
  page.settings = {
      {"model", model},
      {"prompt", prompt.empty() ? "none" : prompt},
      {"prompted joints", joints_text(result.joints)},
      {"conditions", conditions_text(request.labels)},
      {"sampling", s.strategy == "greedy"
                       ? "greedy"
                       : "temperature " + format_number(s.temperature) + ", top-k " +
                             std::to_string(s.top_k) + ", top-p " + format_number(s.top_p)},
      {"seed", std::to_string(s.seed)}};
  return page;
}

std::vector<std::string> generated_files(const std::string& stem) {
  const std::string ending = fs::path(stem).extension().string();
  if (ending == ".html") return {stem};
  for (const std::string& format : written_formats())
    if (ending == "." + format) return {stem};
  return {stem + ".npz", stem + ".bvh", stem + ".html"};
}

Labels parse_labels(const std::vector<std::string>& texts) {
  Labels labels;
  for (const std::string& text : texts) {
    const auto at = text.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == text.size())
      throw UsageError("--label " + text + ": expected name=value");
    labels[text.substr(0, at)] = text.substr(at + 1);
  }
  return labels;
}

void write_generated(const std::string& stem, const Generator& generator,
                     const GenerateRequest& request, const GenerateResult& result,
                     const std::string& model, const std::string& prompt) {
  for (const std::string& file : generated_files(stem)) {
    if (fs::path(file).extension() == ".html")
      write_page(file, generated_page(generator, request, result, model, prompt));
    else
      write_clip(file, result.clip);
  }
}

Table generated_table(const Generator& generator, const GenerateRequest& request,
                      const GenerateResult& result, const std::string& stem) {
  Table table("", {"generated", "value"});
  table.row({"length", format_number(result.clip.seconds()) + " s at " +
                           format_number(result.clip.fps) + " frames per second"});
  table.row({"conditions", conditions_text(request.labels)});
  table.row({"prompted joints", joints_text(result.joints)});
  table.row({"frames where nothing moves", format_fixed(100 * result.frozen, 1) + " %"});
  if (result.context.frames() > 0)
    table.row({"the same in the prompt", format_fixed(100 * result.context_frozen, 1) + " %"});
  table.row({"files", join(generated_files(stem), " ")});
  for (const std::string& note : result.notes) table.note("note: " + note);
  if (generator.description().procedural)
    table.note("note: the model was trained on procedural dances");
  return table;
}

}  // namespace mocaplm
