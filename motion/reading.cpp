#include "motion/reading.h"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

void Remarks::add(const std::string& file, const std::vector<Remark>& remarks) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Remark& remark : remarks) kinds_[remark.kind][file].insert(remark.text);
}

std::vector<std::string> Remarks::sentences() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> all;
  for (const auto& [kind, files] : kinds_) {
    const auto& [file, texts] = *files.begin();
    if (files.size() > 1)
      all.push_back(std::to_string(files.size()) + " files, " + file +
                    " among them: " + *texts.begin() + ".");
    else
      for (const std::string& text : texts) all.push_back(file + ": " + text + ".");
  }
  return all;
}

std::vector<std::string> given_options(const ReadOptions& options) {
  std::vector<std::string> given;
  const auto add = [&](bool is, const char* name) {
    if (is) given.push_back(name);
  };
  add(options.fps.has_value(), "--source-fps");
  add(options.up != UpAxis::automatic, "--up");
  add(options.unit.has_value(), "--unit");
  add(!options.bvh_map.empty(), "--bvh-map");
  add(!options.write_map.empty(), "--write-map");
  add(options.keep_path, "--keep-path");
  add(options.fill_gaps, "--fill-gaps");
  add(options.drop_first > 0, "--drop-first");
  add(!options.body.empty(), "--body");
  return given;
}

void refuse_read_options(const ReadOptions& options, const std::string& why) {
  const std::vector<std::string> given = given_options(options);
  if (!given.empty()) throw UsageError(given.front() + why);
}

double metres_of_unit(const std::string& text) {
  static const std::pair<const char*, double> known[] = {
      {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
  for (const auto& [name, metres] : known)
    if (text == name) return metres;
  char* end = nullptr;
  const double metres = std::strtod(text.c_str(), &end);
  // The comparison refuses nan, too.
  if (text.empty() || *end != 0 || !(metres >= 1e-6 && metres <= 1e6))
    throw UsageError("\"" + text +
                     "\" is no unit of length: expected m, cm, mm, in, ft or metres per unit, a "
                     "number from 1e-6 to 1e6");
  return metres;
}

}  // namespace mocaplm
