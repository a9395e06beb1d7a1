#include "motion/import.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <set>

#include "common/error.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/settings.h"
#include "common/text.h"
#include "motion/floor.h"
#include "motion/formats/formats.h"
#include "motion/formats/retarget_map.h"
#include "motion/import/labels.h"
#include "motion/import/splits.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// What is known of a file before and after it was read.
struct Item {
  DatasetEntry entry;
  std::uint64_t content = 0;
  bool sound = false;
};

// Of all numbers' bits. Never stored: it only has to tell the clips of one import apart.
std::uint64_t content_hash(const Clip& clip) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](const auto& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) {
      std::uint64_t bits;
      std::memcpy(&bits, matrix.data() + i, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
  };
  add(clip.poses);
  add(clip.trans);
  return hash;
}

ReadOptions read_options(const ImportConfig& config, const FileFacts& facts) {
  ReadOptions options;
  options.fps = facts.fps;
  options.up = up_axis_of(config.up);
  options.bvh_map = config.map;
  options.drop_first = facts.drop_first;
  return options;
}

Clip read_source(const ImportConfig& config, const SourceFile& source, const FileFacts& facts,
                 ReadReport& report) {
  Clip clip = read_clip(source.path, read_options(config, facts), &report);
  if (config.align_floor) align_floor(clip);
  clip.name = source.name;
  clip.labels = facts.labels;
  return clip;
}

// One import from the beginning to the end.
class Import {
 public:
  Import(const ImportConfig& config, const ImportJob& job) : config_(config), job_(job) {
    shares_ = parse_shares(config.split);
    if (!config.map.empty()) load_map(config.map);
    load_old();
    std::set<std::string> taken;
    for (const DatasetEntry& entry : old_.entries) taken.insert(entry.name);
    Sources found = find_sources(job.sources, taken);
    sources_ = std::move(found.files);
    report_.ignored = found.ignored;
    if (sources_.empty())
      throw DataError(in_file(join(job.sources, ", ")), "no .npz, .pkl, .bvh or other motion file there");
    refuse_own_files();
    Facts facts = gather_facts(config, sources_);
    facts_ = std::move(facts.files);
    report_.warnings = std::move(facts.warnings);
    check_strata();
    plan();
  }

  ImportReport run() {
    write_dataset(job_.out, job_.existing, [&](const fs::path& directory) {
      read_all(directory);
      return finish();
    });
    report_.dataset.directory = job_.out;
    return std::move(report_);
  }

 private:
  void load_old() {
    if (job_.existing != Existing::append || !is_dataset(job_.out)) return;
    old_ = load_dataset(job_.out);
    if (old_.procedural)
      throw UsageError(job_.out.string() +
                       " holds procedural dances; import motion capture into a dataset of its own");
  }

  // A dataset is swapped as a whole: what lies inside it must not be its own source.
  void refuse_own_files() const {
    const fs::path out = fs::weakly_canonical(job_.out);
    for (const SourceFile& source : sources_) {
      const fs::path path = fs::weakly_canonical(source.path);
      if (std::mismatch(out.begin(), out.end(), path.begin(), path.end()).first == out.end())
        throw UsageError(source.path.string() + " lies inside --out " + job_.out.string() +
                         "; give another folder");
    }
  }

  void check_strata() const {
    std::set<std::string> labels;
    for (const FileFacts& file : facts_)
      for (const auto& [label, value] : file.labels) labels.insert(label);
    for (const std::string& label : config_.stratify)
      if (labels.count(label) == 0)
        throw UsageError("--stratify " + label + ": no file has this label" +
                         did_you_mean(label, {labels.begin(), labels.end()}));
  }

  void plan() {
    std::vector<DatasetEntry> entries;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      DatasetEntry entry;
      entry.name = sources_[i].name;
      entry.file = clip_file(entry.name);
      entry.labels = facts_[i].labels;
      entry.group = facts_[i].group.empty() ? entry.name : facts_[i].group;
      entry.source = sources_[i].path.generic_string();
      entries.push_back(entry);
    }
    shares_ = use_split_lists(config_.split_list, sources_, shares_, entries);
    for (DatasetEntry& entry : entries) items_.push_back({std::move(entry), 0, false});
  }

  void read_all(const fs::path& directory) {
    Progress progress("importing", sources_.size(), "files");
    std::mutex mutex;
    std::map<std::size_t, BrokenFile> broken;
    parallel_for(sources_.size(), job_.threads, [&](std::size_t i) {
      std::string reason;
      try {
        read_one(i, directory, mutex);
      } catch (const DataError& error) {
        if (job_.strict) throw;
        reason = error.what();
      } catch (const std::bad_alloc&) {
        if (job_.strict) throw;
        reason = sources_[i].path.string() + ": too large for this machine's memory";
      }
      const std::lock_guard<std::mutex> lock(mutex);
      if (!reason.empty()) {
        broken[i] = {sources_[i].path.string(), reason};
        progress.print("left out: " + reason);
      }
      progress.add();
    });
    progress.finish();
    for (auto& [index, file] : broken) report_.broken.push_back(std::move(file));
  }

  void read_one(std::size_t i, const fs::path& directory, std::mutex& mutex) {
    Item& item = items_[i];
    ReadReport read;
    const Clip clip = read_source(config_, sources_[i], facts_[i], read);
    item.entry.frames = clip.frames();
    item.entry.fps = clip.fps;
    item.content = content_hash(clip);
    store_clip(directory, item.entry, clip);
    item.sound = true;
    const std::lock_guard<std::mutex> lock(mutex);
    if (!read.retarget.limbs.empty())
      report_.limbs.add(item.entry.name, clip.frames(), read.retarget);
  }

  // Everything that needs all clips: copies, splits, the list.
  Dataset finish() {
    items_.erase(
        std::remove_if(items_.begin(), items_.end(), [](const Item& i) { return !i.sound; }),
        items_.end());
    if (items_.empty())
      throw DataError(in_file(job_.out.string()),
                      "nothing was written: none of the " + std::to_string(sources_.size()) +
                          " files could be read; the first: " + report_.broken.front().reason);
    report_.imported = items_.size();
    add_old_items();
    join_duplicates();
    Dataset dataset;
    for (Item& item : items_) dataset.entries.push_back(std::move(item.entry));
    assign_splits(dataset.entries, shares_, config_.stratify,
                  static_cast<std::uint64_t>(config_.seed));
    std::sort(dataset.entries.begin(), dataset.entries.end(),
              [](const DatasetEntry& a, const DatasetEntry& b) { return a.name < b.name; });
    dataset.import = Json{{"command", "import"}, {"sources", job_.sources}};
    dataset.import.update(settings_json(config_));
    if (!old_.entries.empty()) dataset.import["appended_to"] = old_.import;
    report_.dataset = dataset;
    return dataset;
  }

  void add_old_items() {
    std::set<std::int64_t> lengths;
    for (const Item& item : items_) lengths.insert(item.entry.frames);
    for (const DatasetEntry& entry : old_.entries) {
      Item item{entry, 0, true};
      // Only a clip of the same length can be a copy.
      if (lengths.count(entry.frames) > 0) item.content = content_hash(load_clip(old_, entry));
      items_.push_back(item);
    }
  }

  // Copies of one motion go into one group, and so do the groups that they were in.
  void join_duplicates() {
    std::map<std::uint64_t, std::vector<Item*>> same;
    for (Item& item : items_)
      if (item.content != 0) same[item.content].push_back(&item);
    for (auto& [hash, copies] : same) {
      if (copies.size() < 2) continue;
      std::vector<std::string> names;
      std::set<std::string> groups;
      for (const Item* copy : copies) {
        names.push_back(copy->entry.name);
        groups.insert(copy->entry.group);
      }
      std::sort(names.begin(), names.end());
      report_.duplicates.push_back(names);
      for (Item& item : items_)
        if (groups.count(item.entry.group) > 0) item.entry.group = *groups.begin();
    }
    std::sort(report_.duplicates.begin(), report_.duplicates.end());
  }

  const ImportConfig& config_;
  const ImportJob& job_;
  Shares shares_{};
  Dataset old_;
  std::vector<SourceFile> sources_;
  std::vector<FileFacts> facts_;
  std::vector<Item> items_;
  ImportReport report_;
};

}  // namespace

ImportReport import_motion(const ImportConfig& config, const ImportJob& job) {
  return Import(config, job).run();
}

}  // namespace mocaplm
