#include "viewer/open.h"

#include <algorithm>
#include <set>

#include "common/error.h"
#include "common/text.h"
#include "motion/dataset.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// Collects motions and remembers which of the wanted clip names were found.
class Opener {
 public:
  Opener(const ViewOptions& options, std::vector<std::string>* remarks)
      : options_(options), remarks_(remarks) {
    joints_ = options.joints.empty() ? std::vector<int>() : parse_joints(options.joints);
    trails_ = options.trails.empty() ? std::vector<int>() : parse_joints(options.trails);
  }

  Page open() {
    if (options_.inputs.empty())
      throw UsageError("name at least one motion file or dataset folder");
    for (const std::string& input : options_.inputs) {
      if (fs::is_directory(input)) {
        add_dataset(input);
      } else {
        add(read_clip(input, options_.read), fs::path(input).stem().string(), "");
      }
    }
    for (const std::string& name : options_.clips)
      if (!found_.count(name))
        throw UsageError(
            "no clip is named \"" + name + "\"" + did_you_mean(name, known_) +
            (known_.empty() ? ": --clip chooses from dataset folders, none was given" : ""));
    page_.title = options_.title.empty() ? made_title() : options_.title;
    if (page_.note.empty())
      page_.note = options_.note;
    else if (!options_.note.empty())
      page_.note = options_.note + " (" + page_.note + ")";
    return std::move(page_);
  }

 private:
  void add(Clip clip, const std::string& fallback_name, const std::string& caption) {
    if (page_.motions.size() == kMaxPageMotions)
      throw UsageError("a page shows at most " + std::to_string(kMaxPageMotions) +
                       " motions; name fewer");
    if (clip.name.empty()) clip.name = fallback_name;
    const std::string title = clip.name;
    page_.motions.push_back({title, std::move(clip), joints_, trails_, caption});
  }

  void add_dataset(const std::string& directory) {
    const Dataset dataset = load_dataset(directory);
    if (dataset.procedural) page_.note = "procedural dances, made by formulas, not recorded";
    const std::vector<DatasetEntry> chosen = choose(dataset);
    for (const DatasetEntry& entry : chosen)
      add(load_clip(dataset, entry), entry.name, entry.split + " clip of " + directory);
  }

  std::vector<DatasetEntry> choose(const Dataset& dataset) {
    std::vector<DatasetEntry> chosen;
    for (const DatasetEntry& entry : dataset.entries) known_.push_back(entry.name);
    if (options_.clips.empty()) {
      const std::size_t count = std::min(kDatasetPreview, dataset.entries.size());
      if (count < dataset.entries.size() && remarks_)
        remarks_->push_back("showing the first " + std::to_string(count) + " of " +
                            std::to_string(dataset.entries.size()) + " clips of " +
                            dataset.directory.string() + "; choose with --clip NAME");
      chosen.assign(dataset.entries.begin(),
                    dataset.entries.begin() + static_cast<std::ptrdiff_t>(count));
      return chosen;
    }
    for (const std::string& name : options_.clips)
      for (const DatasetEntry& entry : dataset.entries)
        if (entry.name == name) {
          chosen.push_back(entry);
          found_.insert(name);
        }
    return chosen;
  }

  std::string made_title() const {
    std::vector<std::string> names;
    for (const PageMotion& motion : page_.motions) names.push_back(motion.title);
    if (names.size() <= 3) return join(names, ", ");
    const std::string count = std::to_string(names.size());
    if (options_.inputs.size() > 1) return count + " motions";
    const fs::path folder = fs::absolute(options_.inputs[0]).lexically_normal();
    return count + " motions of " +
           (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  }

  const ViewOptions& options_;
  std::vector<std::string>* remarks_;
  std::vector<int> joints_, trails_;
  std::vector<std::string> known_;
  std::set<std::string> found_;
  Page page_;
};

}  // namespace

Page open_page(const ViewOptions& options, std::vector<std::string>* remarks) {
  Page page = Opener(options, remarks).open();
  if (page.motions.empty()) throw UsageError("there is nothing to show");
  page.highlight_name = "highlighted joints: " + join(options.joints, ", ");
  return page;
}

void check_page_path(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension != ".html" && extension != ".htm")
    throw UsageError("the page \"" + path.string() + "\" must be named .html");
}

}  // namespace mocaplm
