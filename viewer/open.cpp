#include "viewer/open.h"

#include <map>

#include "common/error.h"
#include "common/text.h"
#include "motion/inputs.h"
#include "motion/skeleton.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// Collects motions.
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
    for (const MotionInput& input : chosen()) add(input);
    page_.title = options_.title.empty() ? made_title() : options_.title;
    if (page_.note.empty())
      page_.note = options_.note;
    else if (!options_.note.empty())
      page_.note = options_.note + " (" + page_.note + ")";
    return std::move(page_);
  }

 private:
  // All that is named; of a dataset's folder, where no clips are, the first ones.
  std::vector<MotionInput> chosen() {
    std::vector<MotionInput> shown;
    std::map<const Dataset*, std::size_t> counts;
    for (const MotionInput& input : find_motions(options_.inputs, options_.clips, options_.read)) {
      if (input.dataset && options_.clips.empty()) {
        const std::size_t count = ++counts[input.dataset.get()];
        if (count == kDatasetPreview + 1) remark_preview(*input.dataset);
        if (count > kDatasetPreview) continue;
      }
      shown.push_back(input);
    }
    return shown;
  }

  void remark_preview(const Dataset& dataset) {
    if (remarks_)
      remarks_->push_back("showing the first " + std::to_string(kDatasetPreview) + " of " +
                          std::to_string(dataset.entries.size()) + " clips of " +
                          dataset.directory.string() + "; choose with --clip NAME");
  }

  void add(const MotionInput& input) {
    for (NamedMotion& motion : read_motions(input, options_.read)) {
      if (page_.motions.size() == kMaxPageMotions)
        throw UsageError("a page shows at most " + std::to_string(kMaxPageMotions) +
                         " motions; name fewer");
      std::string caption;
      if (input.dataset) {
        if (input.dataset->procedural)
          page_.note = "procedural dances, made by formulas, not recorded";
        caption = motion.read.entry->split + " clip of " + input.dataset->directory.string();
      }
      page_.motions.push_back(
          {motion.name, std::move(motion.read.clip), joints_, trails_, caption});
    }
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
