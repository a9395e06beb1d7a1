#include "common/suggest.h"

#include <algorithm>

#include "common/text.h"

namespace mocaplm {

namespace {

constexpr std::size_t kLongestName = 200;

// Changes that are still taken for a slip: names of two letters are often one change apart.
std::size_t forgiven_changes(std::size_t length) {
  if (length < 5) return std::min<std::size_t>(length - 1, 1);
  return length < 8 ? 2 : length / 3;
}

// The only candidate that begins with the word, or "".
std::string begun_name(const std::string& word, const std::vector<std::string>& candidates) {
  std::string found;
  for (const std::string& candidate : candidates) {
    if (lower(candidate).rfind(word, 0) != 0 || candidate == found) continue;
    if (!found.empty()) return "";
    found = candidate;
  }
  return found;
}

}  // namespace

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearest_name(const std::string& given, const std::vector<std::string>& candidates) {
  if (given.empty() || given.size() > kLongestName) return "";
  const std::string word = lower(given);
  std::string best;
  std::size_t fewest = forgiven_changes(word.size()) + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > kLongestName || candidate == given) continue;
    const std::size_t changes = edit_distance(word, lower(candidate));
    if (changes >= fewest) continue;
    fewest = changes;
    best = candidate;
  }
  return best.empty() && word.size() > 2 ? begun_name(word, candidates) : best;
}

}  // namespace mocaplm
