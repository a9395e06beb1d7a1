#include "motion/chosen_clips.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void check_label(const Dataset& dataset, const std::string& label, const std::string& asker) {
  const std::vector<std::string> labels = dataset.label_names();
  if (!holds(labels, label))
    throw UsageError(asker + ": " + dataset.directory.string() + " has no label \"" + label + "\"" +
                     known_names(label, labels, "Its labels"));
}

void check_label_value(const Dataset& dataset, const std::string& label, const std::string& value,
                       const std::string& asker) {
  const std::vector<std::string> values = dataset.label_values(label);
  if (!holds(values, value))
    throw UsageError(asker + ": no clip of " + dataset.directory.string() + " has the " + label +
                     " \"" + value + "\"" + known_names(value, values, "Its values"));
}

std::pair<std::string, std::string> parse_where(const std::string& text) {
  const auto at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    throw UsageError("--where " + text + ": expected label=value");
  return {text.substr(0, at), text.substr(at + 1)};
}

std::vector<DatasetEntry> chosen_entries(const Dataset& dataset, const std::string& split,
                                         const std::vector<std::string>& where) {
  std::vector<DatasetEntry> chosen = split.empty() ? dataset.entries : dataset.split(split);
  for (const std::string& text : where) {
    const std::pair<std::string, std::string> asked = parse_where(text);
    check_label(dataset, asked.first, "--where " + text);
    check_label_value(dataset, asked.first, asked.second, "--where " + text);
    chosen.erase(std::remove_if(chosen.begin(), chosen.end(),
                                [&](const DatasetEntry& entry) {
                                  const auto found = entry.labels.find(asked.first);
                                  return found == entry.labels.end() ||
                                         found->second != asked.second;
                                }),
                 chosen.end());
  }
  if (chosen.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "has no clip" + (split.empty() ? "" : " in split \"" + split + "\"") +
                        (where.empty() ? "" : " with " + join(where, ", ")));
  return chosen;
}

}  // namespace mocaplm
