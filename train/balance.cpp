#include "train/balance.h"

#include <cmath>
#include <map>

namespace mocaplm {

namespace {

std::string value_of(const EncodedClip& clip, const std::string& label) {
  const auto found = clip.values.find(label);
  return found == clip.values.end() ? "" : found->second;
}

}  // namespace

void balance(Corpus& corpus, const std::string& label, double share) {
  std::map<std::string, double> tokens;  // as many for each frame
  for (const EncodedClip& clip : corpus.clips)
    tokens[value_of(clip, label)] += static_cast<double>(clip.ids.size());
  for (EncodedClip& clip : corpus.clips)
    clip.weight = std::pow(tokens.at(value_of(clip, label)), -share);
}

}  // namespace mocaplm
