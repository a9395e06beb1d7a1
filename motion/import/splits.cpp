#include "motion/import/splits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/files.h"
#include "common/random.h"
#include "common/text.h"

namespace mocaplm {

namespace {

struct Group {
  std::string name, stratum, split;  // split: "" until it is decided
  double seconds = 0;
};

std::string stratum_of(const DatasetEntry& entry, const std::vector<std::string>& labels) {
  std::string stratum;
  for (const std::string& label : labels) {
    const auto found = entry.labels.find(label);
    stratum += (found == entry.labels.end() ? "" : found->second) + "\n";
  }
  return stratum;
}

// Groups with their clips' total; the first clip's labels are the group's.
std::map<std::string, Group> collect(const std::vector<DatasetEntry>& entries,
                                     const std::vector<std::string>& stratify) {
  std::map<std::string, Group> groups;
  for (const DatasetEntry& entry : entries) {
    const auto [found, fresh] = groups.try_emplace(entry.group);
    Group& group = found->second;
    if (fresh) group = {entry.group, stratum_of(entry, stratify), "", 0};
    group.seconds += entry.seconds();
    if (!group.split.empty() && !entry.split.empty() && group.split != entry.split)
      throw DataError(in_file(entry.name), "is in " + entry.split +
                                               ", but other clips of its group \"" + entry.group +
                                               "\" are in " + group.split);
    if (group.split.empty()) group.split = entry.split;
  }
  return groups;
}

std::size_t index_of_split(const std::string& name) {
  const auto& names = split_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// Gives each group of one stratum a split.
void divide(std::vector<Group*>& groups, const Shares& shares, std::uint64_t seed) {
  std::sort(groups.begin(), groups.end(), [&](const Group* a, const Group* b) {
    const auto key = [&](const Group* g) {
      return std::make_pair(stable_hash(g->name, seed), g->name);
    };
    return key(a) < key(b);
  });
  double total = 0;
  for (const Group* group : groups) total += group->seconds;
  std::array<double, 3> lacking{};
  std::array<bool, 3> filled{};
  for (std::size_t s = 0; s < 3; ++s) {
    lacking[s] = shares[s] * total;
    filled[s] = shares[s] <= 0;
  }
  std::size_t open = 0;
  for (const Group* group : groups) {
    if (group->split.empty()) {
      ++open;
    } else {
      lacking[index_of_split(group->split)] -= group->seconds;
      filled[index_of_split(group->split)] = true;
    }
  }
  if (open > 0 && shares[0] + shares[1] + shares[2] <= 0)
    throw DataError(in_file("--split-list"), "clips of the group \"" + groups.front()->name +
                                                 "\" are in no list, and every split has a list");
  const auto to_fill = static_cast<std::size_t>(std::count(filled.begin(), filled.end(), false));
  const bool enough = open >= to_fill;
  // Equal needs are met in an order that changes from stratum to stratum.
  const bool test_first = !groups.empty() && stable_hash(groups.front()->stratum, seed) % 2 == 1;
  const std::array<std::size_t, 3> order =
      test_first ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2};
  for (Group* group : groups) {
    if (!group->split.empty()) continue;
    const auto empty = static_cast<std::size_t>(std::count(filled.begin(), filled.end(), false));
    const bool must_fill = enough && open <= empty;
    std::size_t best = 3;
    for (const std::size_t s : order) {
      if (shares[s] <= 0 || (must_fill && filled[s])) continue;
      if (best == 3 || lacking[s] > lacking[best]) best = s;
    }
    group->split = split_names()[best];
    lacking[best] -= group->seconds;
    filled[best] = true;
    --open;
  }
}

}  // namespace

Shares parse_shares(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  Shares shares{};
  bool good = parts.size() == 3;
  double sum = 0;
  for (std::size_t s = 0; good && s < 3; ++s) {
    const char* end = parts[s].data() + parts[s].size();
    const auto result = std::from_chars(parts[s].data(), end, shares[s]);
    good = result.ec == std::errc() && result.ptr == end && shares[s] >= 0 && shares[s] <= 1;
    sum += shares[s];
  }
  if (!good || std::abs(sum - 1) > 1e-6)
    throw UsageError("--split " + text +
                     ": expected the shares of train, validation and test, which sum to 1, such as "
                     "0.8,0.1,0.1");
  return shares;
}

void assign_splits(std::vector<DatasetEntry>& entries, const Shares& shares,
                   const std::vector<std::string>& stratify, std::uint64_t seed) {
  std::map<std::string, Group> groups = collect(entries, stratify);
  std::map<std::string, std::vector<Group*>> strata;
  for (auto& [name, group] : groups) strata[group.stratum].push_back(&group);
  for (auto& [name, members] : strata) divide(members, shares, seed);
  for (DatasetEntry& entry : entries) entry.split = groups.at(entry.group).split;
}

Shares use_split_lists(const std::vector<std::string>& lists,
                       const std::vector<SourceFile>& sources, const Shares& shares,
                       std::vector<DatasetEntry>& entries) {
  Shares left = shares;
  for (const std::string& list : lists) {
    const std::size_t equals = list.find('=');
    const std::string name = list.substr(0, equals);
    if (equals == std::string::npos || index_of_split(name) == split_names().size())
      throw UsageError("--split-list " + list +
                       ": expected train=FILE, validation=FILE or test=FILE");
    const std::string file = list.substr(equals + 1);
    PathList wanted;
    std::vector<std::size_t> line_of;
    std::size_t line = 0;
    for (std::string text : split(read_file(file, std::uintmax_t{64} << 20), '\n')) {
      ++line;
      if (!text.empty() && text.back() == '\r') text.pop_back();
      if (text.empty()) continue;
      wanted.add(text, file, line);
      line_of.push_back(line);
    }
    std::vector<bool> found(line_of.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const auto at = wanted.find(sources[i]);
      if (!at) continue;
      if (!entries[i].split.empty() && entries[i].split != name)
        throw DataError(
            at_line(file, line_of[*at]),
            "\"" + entries[i].name + "\" is in the list of " + entries[i].split + " already");
      entries[i].split = name;
      found[*at] = true;
    }
    for (std::size_t k = 0; k < found.size(); ++k)
      if (!found[k])
        throw DataError(at_line(file, line_of[k]),
                        "no clip is called \"" + wanted.names()[k] + "\"");
    left[index_of_split(name)] = 0;
  }
  const double sum = left[0] + left[1] + left[2];
  for (double& share : left) share = sum > 0 ? share / sum : share;
  return left;
}

}  // namespace mocaplm
