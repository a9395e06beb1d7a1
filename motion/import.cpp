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
#include "motion/formats/retarget_map.h"
#include "motion/formats/scene.h"
#include "motion/import/labels.h"
#include "motion/import/splits.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// What is known of a file before and after it was read.
struct Item {
  DatasetEntry entry;
  std::uint64_t content = 0;
  BodyPosture posture;
  RetargetReport retarget;
  std::string part;  // of a file with several: what tells it from the others
};

const char* const kParts = ".parts/";

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
  if (config.unit > 0) options.unit = config.unit;
  options.bvh_map = config.map;
  options.keep_path = config.keep_path;
  options.fill_gaps = config.fill_gaps;
  options.drop_first = facts.drop_first;
  options.body = config.body;
  return options;
}

// What tells a clip from the others of its file: "2" of "walk_2".
std::string part_of(const Clip& clip, const SourceFile& source) {
  const std::string stem = source.path.stem().string() + "_";
  return clip.name.compare(0, stem.size(), stem) == 0 ? clip.name.substr(stem.size()) : clip.name;
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
      throw DataError(in_file(join(job.sources, ", ")),
                      "no .npz, .pkl, .bvh or other motion file there");
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
      return finish(directory);
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
    planned_ = std::move(entries);
    items_.resize(sources_.size());
  }

  void read_all(const fs::path& directory) {
    Progress progress("importing", sources_.size(), "files");
    std::mutex mutex;
    std::map<std::size_t, BrokenFile> broken;
    std::map<std::size_t, std::vector<Remark>> remarks;
    Troubles left_out, remarked;
    parallel_for(sources_.size(), job_.threads, [&](std::size_t i) {
      std::string reason;
      std::vector<Remark> found;
      try {
        found = read_one(i, directory);
      } catch (const NoMotion& error) {
        // A prop or a standing character beside the takes is no broken file.
        found.push_back(
            {"holds no motion", "was left out, for it " + behind_file(error.what(), i)});
      } catch (const DataError& error) {
        if (job_.strict) throw;
        reason = error.what();
      } catch (const std::bad_alloc&) {
        if (job_.strict) throw;
        reason = sources_[i].path.string() + ": too large for this machine's memory";
      }
      const std::string file = sources_[i].path.string();
      const std::lock_guard<std::mutex> lock(mutex);
      if (!reason.empty()) {
        broken[i] = {file, reason};
        if (left_out.add({file, {kind_of_error(reason, file), reason}}))
          progress.print("left out: " + reason);
      }
      for (const Remark& remark : found)
        if (remarked.add({file, remark})) progress.print("note: " + file + ": " + remark.text);
      if (!found.empty()) remarks[i] = std::move(found);
      progress.add();
    });
    progress.finish();
    for (auto& [index, file] : broken) report_.broken.push_back(std::move(file));
    for (auto& [index, found] : remarks)
      for (Remark& remark : found)
        report_.remarks.push_back({sources_[index].path.string(), std::move(remark)});
  }

  // A reader's message without the file's name, with which it begins.
  std::string behind_file(const std::string& message, std::size_t i) const {
    const std::string file = sources_[i].path.string() + ": ";
    return starts_with(message, file) ? message.substr(file.size()) : message;
  }

  // Reads and stores the clips of one file; returns what is to be said of them. Those of a file
  // with several lie in a folder of their own until the names of all are known.
  std::vector<Remark> read_one(std::size_t i, const fs::path& directory) {
    const FileFacts& facts = facts_[i];
    std::vector<ReadMotion> motions = job_.read(sources_[i].path, read_options(config_, facts));
    std::vector<Item> items;
    std::vector<Remark> found;
    for (std::size_t k = 0; k < motions.size(); ++k) {
      Clip& clip = motions[k].clip;
      ReadReport& read = motions[k].report;
      Item item;
      item.entry = planned_[i];
      if (motions.size() > 1) {
        item.part = part_of(clip, sources_[i]);
        item.entry.file = kParts + std::to_string(i) + "/" + std::to_string(k) + ".npz";
        fs::create_directories((directory / item.entry.file).parent_path());
        for (Remark& remark : read.remarks) remark.text = item.part + ": " + remark.text;
      }
      if (config_.align_floor) align_floor(clip);
      clip.name = sources_[i].name;
      clip.labels = facts.labels;
      item.entry.frames = clip.frames();
      item.entry.fps = clip.fps;
      item.content = content_hash(clip);
      item.posture = measure_posture(clip, kPostureFrames);
      item.retarget = std::move(read.retarget);
      store_clip(directory, item.entry, clip);
      std::vector<Remark> odd = unlikely(item.posture, item.retarget);
      for (std::vector<Remark>* remarks : {&read.remarks, &odd})
        found.insert(found.end(), remarks->begin(), remarks->end());
      items.push_back(std::move(item));
    }
    items_[i] = std::move(items);
    return found;
  }

  // Clips of one file are called by it and by their part; a number keeps them from all others.
  void name_parts(const fs::path& directory) {
    std::set<std::string> taken;
    for (const DatasetEntry& entry : old_.entries) taken.insert(entry.name);
    for (const SourceFile& source : sources_) taken.insert(source.name);
    for (std::size_t i = 0; i < items_.size(); ++i)
      for (Item& item : items_[i]) {
        if (items_[i].size() < 2) continue;
        const std::string name = clip_name(sources_[i].name + "_" + item.part);
        item.entry.name = name;
        for (int number = 2; !taken.insert(item.entry.name).second; ++number)
          item.entry.name = name + "_" + std::to_string(number);
        const fs::path stored = directory / item.entry.file;
        item.entry.file = clip_file(item.entry.name);
        fs::rename(stored, directory / item.entry.file);
      }
    fs::remove_all(directory / kParts);
  }

  // Everything that needs all clips: names of parts, copies, splits, the list.
  Dataset finish(const fs::path& directory) {
    name_parts(directory);
    std::vector<Item> items;
    for (std::vector<Item>& file : items_)
      for (Item& item : file) items.push_back(std::move(item));
    if (items.empty())
      throw DataError(in_file(job_.out.string()),
                      "nothing was written: none of the " + std::to_string(sources_.size()) +
                          " files could be read; the first: " +
                          (report_.broken.empty() ? report_.remarks.front().file + " " +
                                                        report_.remarks.front().remark.text
                                                  : report_.broken.front().reason));
    report_.imported = items.size();
    for (const Item& item : items) {
      if (!item.retarget.limbs.empty())
        report_.limbs.add(item.entry.name, item.entry.frames, item.retarget);
      report_.figures.add(item.entry.name, item.posture, item.retarget);
    }
    add_old_items(items);
    join_duplicates(items);
    Dataset dataset;
    for (Item& item : items) dataset.entries.push_back(std::move(item.entry));
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

  void add_old_items(std::vector<Item>& items) {
    std::set<std::int64_t> lengths;
    for (const Item& item : items) lengths.insert(item.entry.frames);
    for (const DatasetEntry& entry : old_.entries) {
      Item item;
      item.entry = entry;
      // Only a clip of the same length can be a copy.
      if (lengths.count(entry.frames) > 0) item.content = content_hash(load_clip(old_, entry));
      items.push_back(item);
    }
  }

  // Copies of one motion go into one group, and so do the groups that they were in.
  void join_duplicates(std::vector<Item>& items) {
    std::map<std::uint64_t, std::vector<Item*>> same;
    for (Item& item : items)
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
      for (Item& item : items)
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
  std::vector<DatasetEntry> planned_;     // one for each source
  std::vector<std::vector<Item>> items_;  // of each source, those of its clips
  ImportReport report_;
};

}  // namespace

ImportReport import_motion(const ImportConfig& config, const ImportJob& job) {
  return Import(config, job).run();
}

}  // namespace mocaplm
