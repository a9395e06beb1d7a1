// Condition tokens: one id a label value, after the bins.
#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

int Tokenizer::vocabulary() const {
  std::size_t all = static_cast<std::size_t>(kFirstBin) + static_cast<std::size_t>(bins());
  for (const auto& label : labels_) all += label.second.size();
  return static_cast<int>(all);
}

void Tokenizer::add_label_values(const std::string& label, const std::vector<std::string>& values) {
  if (label.empty()) throw UsageError("a label needs a name");
  for (const std::string& value : values) {
    if (value.empty()) throw UsageError("label \"" + label + "\" has an empty value");
    if (knows(label, value)) continue;
    // A label that is not the last one goes on in a new block: ids already given stay.
    if (labels_.empty() || labels_.back().first != label) labels_.push_back({label, {}});
    labels_.back().second.push_back(value);
  }
}

bool Tokenizer::knows(const std::string& label, const std::string& value) const {
  for (const auto& [name, values] : labels_)
    if (name == label && std::find(values.begin(), values.end(), value) != values.end())
      return true;
  return false;
}

std::int32_t Tokenizer::label_id(const std::string& label, const std::string& value) const {
  std::int32_t id = kFirstBin + bins();
  std::vector<std::string> names, known;
  for (const auto& [name, values] : labels_) {
    names.push_back(name);
    if (name == label) {
      const auto found = std::find(values.begin(), values.end(), value);
      if (found != values.end()) return id + static_cast<std::int32_t>(found - values.begin());
      known.insert(known.end(), values.begin(), values.end());
    }
    id += static_cast<std::int32_t>(values.size());
  }
  if (known.empty())
    throw DataError(in_file("tokenizer"),
                    "knows no label \"" + label + "\"" +
                        (names.empty() ? ": it has none" : known_names(label, names)));
  throw DataError(in_file("tokenizer"), "label \"" + label + "\" has no value \"" + value + "\"" +
                                            known_names(value, known));
}

}  // namespace mocaplm
