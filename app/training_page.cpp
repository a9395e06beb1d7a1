#include "app/training_page.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/training_samples.h"
#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "common/text.h"
#include "model/directory.h"
#include "motion/formats/formats.h"
#include "viewer/assets.h"
#include "viewer/plot.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// More rows than these are thinned evenly, the last one kept.
constexpr std::size_t kRows = 60;
// Samples on the stage, beside the clip that they go on from.
constexpr std::size_t kShownSamples = 5;

std::vector<Json> read_log(const fs::path& path) {
  std::vector<Json> lines;
  std::istringstream text(read_file(path));
  for (std::string line; std::getline(text, line);) {
    const std::string place = path.string() + ", line " + std::to_string(lines.size() + 1);
    lines.push_back(parse_json(line, place));
    if (!lines.back().is_object() || !lines.back().contains("step"))
      throw DataError(in_file(path), "line " + std::to_string(lines.size()) +
                                         " is not a training log's: it has no \"step\"");
  }
  if (lines.empty()) throw DataError(in_file(path), "the log is empty: nothing was trained");
  return lines;
}

// A key that an older log lacks, or that was not a finite number, is left out of plots.
double value(const Json& line, const char* key) {
  const auto at = line.find(key);
  return at != line.end() && at->is_number() ? at->get<double>() : std::nan("");
}

PlotSeries series(const std::vector<Json>& log, const std::string& name, const char* key) {
  PlotSeries out;
  out.name = name;
  for (const Json& line : log) out.points.push_back({value(line, "step"), value(line, key), ""});
  return out;
}

Json cell(const Json& line, const char* key) {
  const double number = value(line, key);
  return std::isfinite(number) ? Json(number) : Json();
}

Table log_table(const std::vector<Json>& log) {
  Table table("Log", {"step", "bits/frame", "validation", "learning rate", "tokens/s", "time"});
  table.digits({0, 2, 2, 6, 0, -1});
  const std::size_t stride = (log.size() + kRows - 1) / kRows;
  for (std::size_t i = (log.size() - 1) % stride; i < log.size(); i += stride) {
    const Json& line = log[i];
    table.row({format_number(value(line, "step")), cell(line, "bits_per_frame"),
               cell(line, "validation_bits_per_frame"), cell(line, "learning_rate"),
               cell(line, "tokens_per_second"), format_duration(value(line, "seconds"))});
  }
  if (stride > 1)
    table.note("each " + std::to_string(stride) + "th of " + std::to_string(log.size()) +
               " lines of log.jsonl");
  return table;
}

Table summary_table(const std::vector<Json>& log) {
  const Json* best = &log.front();
  for (const Json& line : log)
    if (value(line, "validation_loss") < value(*best, "validation_loss")) best = &line;
  const Json& last = log.back();
  Table table("Summary", {"", "value"});
  table.row({"steps", format_number(value(last, "step"))});
  table.row({"time", format_duration(value(last, "seconds"))});
  table.row(
      {"best validation, bits/frame", format_fixed(value(*best, "validation_bits_per_frame"), 2)});
  table.row({"best validation, nats/token", format_fixed(value(*best, "validation_loss"), 4)});
  table.row({"at step", format_number(value(*best, "step"))});
  table.row({"waited for data", format_duration(value(last, "seconds_waiting_for_data"))});
  return table;
}

// The validation that this log tells of the step; empty when there is none.
std::string validation_text(const std::vector<Json>& log, std::int64_t step) {
  for (const Json& line : log)
    if (value(line, "step") == static_cast<double>(step))
      return format_fixed(value(line, "validation_bits_per_frame"), 1) + " bits/frame";
  return "";
}

// The clip that all samples go on from, and some of them, evenly chosen, the last one included.
void add_samples(const fs::path& run, const std::vector<Json>& log, Page& page) {
  const TrainingSampleFiles files = training_samples(run);
  if (files.samples.empty() || assets::three_js.empty()) return;
  if (load_description(run).procedural) page.note = "trained on procedural dances";
  page.motions.push_back({"clip",
                          read_clip(files.clip, {}),
                          {},
                          {},
                          "A clip of the validation split; each sample goes on from its first " +
                              format_number(kSamplePrompt) + " s"});
  const std::size_t shown = std::min(kShownSamples, files.samples.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const std::size_t at = shown > 1 ? i * (files.samples.size() - 1) / (shown - 1) : 0;
    const auto& [step, file] = files.samples[at];
    page.motions.push_back({"step " + std::to_string(step),
                            read_clip(file, {}),
                            {},
                            {},
                            "Sampled during training. Validation: " + validation_text(log, step)});
  }
}

}  // namespace

Page training_page(const fs::path& run) {
  const std::vector<Json> log = read_log(run / "log.jsonl");
  Page page;
  page.title = "Training: " + run.lexically_normal().string();
  Plot loss{"Bits a frame", "step", "bits/frame", false, false, {}};
  loss.series = {series(log, "training", "bits_per_frame"),
                 series(log, "validation", "validation_bits_per_frame")};
  page.plots.push_back({plot_svg(loss), log_table(log)});
  Plot rate{"Learning rate", "step", "learning rate", false, false, {}};
  rate.series = {series(log, "", "learning_rate")};
  page.plots.push_back({plot_svg(rate), summary_table(log)});
  add_samples(run, log, page);
  if (fs::exists(run / "settings.json")) add_settings(page, load_json(run / "settings.json"));
  return page;
}

}  // namespace mocaplm
