#include "emulator/evaluation/split.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/random.h"

namespace mocaplm {

namespace {

std::string clips_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " clip" : " clips");
}

void sort_by_name(std::vector<DatasetEntry>& entries) {
  std::sort(entries.begin(), entries.end(),
            [](const DatasetEntry& a, const DatasetEntry& b) { return a.name < b.name; });
}

}  // namespace

ClipSplit split_clips(const std::vector<DatasetEntry>& entries, double test_share,
                      std::uint64_t seed, const std::string& what) {
  if (!(test_share > 0 && test_share < 1))
    throw UsageError("the share of clips to test against must lie between 0 and 1");
  if (entries.size() < kFewestToFit + kFewestToTest)
    throw DataError(in_file(what),
                    "has " + clips_text(entries.size()) + ", expected " +
                        std::to_string(kFewestToFit + kFewestToTest) +
                        " or more: some to fit to and unseen others to test against");
  std::map<std::string, std::vector<DatasetEntry>> groups;
  for (const DatasetEntry& entry : entries) groups[entry.group].push_back(entry);
  std::vector<std::string> order;
  for (const auto& group : groups) order.push_back(group.first);
  Random(stable_hash(what, seed)).shuffle(order);

  const double wanted = std::max(static_cast<double>(kFewestToTest),
                                 std::round(test_share * static_cast<double>(entries.size())));
  ClipSplit split;
  for (const std::string& name : order) {
    const std::vector<DatasetEntry>& group = groups[name];
    const bool to_test = static_cast<double>(split.test.size()) < wanted &&
                         entries.size() - split.test.size() - group.size() >= kFewestToFit;
    std::vector<DatasetEntry>& side = to_test ? split.test : split.fit;
    side.insert(side.end(), group.begin(), group.end());
  }
  if (split.fit.size() < kFewestToFit || split.test.size() < kFewestToTest)
    throw DataError(in_file(what), "its " + clips_text(entries.size()) + " are of " +
                                       std::to_string(groups.size()) +
                                       (groups.size() == 1 ? " group" : " groups") +
                                       ", which are not separated: too few to fit to some and test "
                                       "against unseen others");
  sort_by_name(split.fit);
  sort_by_name(split.test);
  return split;
}

}  // namespace mocaplm
