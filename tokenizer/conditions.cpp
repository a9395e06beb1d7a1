#include "tokenizer/conditions.h"

namespace mocaplm {

std::vector<std::int32_t> condition_prefix(const Tokenizer& tokenizer,
                                           const std::vector<std::string>& conditions,
                                           const Labels& labels) {
  std::vector<std::int32_t> prefix = {Tokenizer::kStart};
  for (const std::string& name : conditions) {
    const auto found = labels.find(name);
    const bool known = found != labels.end() && tokenizer.knows(name, found->second);
    prefix.push_back(known ? tokenizer.label_id(name, found->second) : Tokenizer::kMask);
  }
  return prefix;
}

}  // namespace mocaplm
