// One self-contained HTML page that plays motions and shows plots and tables: three.js, data, style
// and script are all inside, it is opened straight from disk and asks nothing of any network.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/json.h"
#include "common/table.h"
#include "motion/clip.h"

namespace mocaplm {

struct PageMotion {
  std::string title;                    // short: it stands under the figure
  Clip clip;                            // any rate; above 60 fps every n-th frame is shown
  std::vector<int> highlighted_joints;  // drawn in the colour of given joints (a prompt's)
  std::vector<int> trails;  // joints that draw their path; empty: both wrists, off at first
  std::string caption;      // a sentence for the list below the stage
};

// A picture (viewer/plot.h, viewer/chart.h) with its numbers in a table beside it.
struct PagePlot {
  std::string svg;  // markup, put into the page as it is
  Table numbers;
};

struct Page {
  std::string title;
  std::string note;                             // shown beside the title, e.g. "procedural dances"
  std::string highlight_name = "given joints";  // what highlighted_joints are, for the legend
  std::vector<PageMotion> motions;  // drawn left to right, or overlaid, on a common clock
  std::vector<PagePlot> plots;
  std::vector<Table> tables;
  std::vector<std::pair<std::string, std::string>> settings;  // name, value
};

// A setting for each value of a JSON object, those of inner objects after one another: numbers in
// their shortest form, lists with commas, a dash for null and for lists without entries.
void add_settings(Page& page, const Json& json);

// All text is escaped. Throws UsageError when there is neither motion nor plot nor table or a joint
// does not exist, DataError when a clip is not valid (check_clip) or there are motions and this
// build has no three.js.
std::string render_page(const Page& page);
void write_page(const std::filesystem::path& path, const Page& page);

}  // namespace mocaplm
