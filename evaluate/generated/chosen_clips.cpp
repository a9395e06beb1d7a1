#include "evaluate/generated/chosen_clips.h"

#include <algorithm>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

bool chosen(const DatasetEntry& entry, const std::vector<std::string>& where) {
  for (const std::string& text : where) {
    const auto at = text.find('=');
    if (at == std::string::npos) throw UsageError("--where " + text + ": expected label=value");
    const auto found = entry.labels.find(text.substr(0, at));
    if (found == entry.labels.end() || found->second != text.substr(at + 1)) return false;
  }
  return true;
}

// The first condition that no clip of the dataset meets, with the nearest that one does.
std::string unmet_condition(const Dataset& dataset, const std::vector<std::string>& where) {
  for (const std::string& text : where) {
    const auto at = text.find('=');
    const std::string label = text.substr(0, at), value = text.substr(at + 1);
    const auto labels = dataset.label_names(), values = dataset.label_values(label);
    if (std::find(labels.begin(), labels.end(), label) == labels.end())
      return ": it has no label \"" + label + "\"" + known_names(label, labels, "Labels");
    if (std::find(values.begin(), values.end(), value) == values.end())
      return ": no clip has this " + label + known_names(value, values, "Values");
  }
  return "";
}

}  // namespace

std::vector<DatasetEntry> chosen_entries(const Dataset& dataset, const std::string& split,
                                         const std::vector<std::string>& where) {
  std::vector<DatasetEntry> entries;
  for (const DatasetEntry& entry : dataset.split(split))
    if (chosen(entry, where)) entries.push_back(entry);
  if (entries.empty())
    throw DataError(in_file(dataset.directory.string()),
                    "no clip in split \"" + split + "\"" +
                        (where.empty() ? "" : " with " + join(where, ", ")) +
                        unmet_condition(dataset, where));
  return entries;
}

Labels known_conditions(const Labels& labels, const std::vector<std::string>& conditions,
                        const Tokenizer& tokenizer) {
  Labels known;
  for (const std::string& name : conditions) {
    const auto found = labels.find(name);
    if (found != labels.end() && tokenizer.knows(name, found->second)) known.insert(*found);
  }
  return known;
}

}  // namespace mocaplm
