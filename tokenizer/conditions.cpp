#include "tokenizer/conditions.h"

namespace mocaplm {

Labels known_conditions(const Tokenizer& tokenizer, const std::vector<std::string>& conditions,
                        const Labels& labels) {
  Labels known;
  for (const std::string& name : conditions) {
    const auto found = labels.find(name);
    if (found != labels.end() && tokenizer.knows(name, found->second)) known.insert(*found);
  }
  return known;
}

std::vector<std::int32_t> condition_prefix(const Tokenizer& tokenizer,
                                           const std::vector<std::string>& conditions,
                                           const Labels& labels) {
  const Labels known = known_conditions(tokenizer, conditions, labels);
  std::vector<std::int32_t> prefix = {Tokenizer::kStart};
  for (const std::string& name : conditions) {
    const auto found = known.find(name);
    prefix.push_back(found == known.end() ? Tokenizer::kMask
                                          : tokenizer.label_id(name, found->second));
  }
  return prefix;
}

}  // namespace mocaplm
