// What `mocaplm import` can be told; stored resolved in dataset.json under "import".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/formats/up_axis.h"

namespace mocaplm {

struct ImportConfig {
  std::string up = "auto";
  double fps = 0;
  std::int64_t drop_first = 0;
  std::string map;
  double unit = 0;
  bool keep_path = false;
  bool fill_gaps = false;
  std::string body;
  bool align_floor = false;
  std::string label_from_dir;
  std::string label_regex;
  std::string label_csv;
  std::vector<std::string> csv_labels;
  std::string csv_fps, csv_drop_first;
  std::string group;
  std::string split = "0.8,0.1,0.1";
  std::vector<std::string> split_list;
  std::vector<std::string> stratify;
  std::int64_t seed = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("up", up, up_axis_names(), "which axis of the files points up (auto: by format)");
    v.number("fps", fps, 0, 10000,
             "frames per second, where the files' header is wrong; 0: as they say");
    v.integer("drop_first", drop_first, 0, 1000000, "leading frames to leave out");
    v.text("map", map, "JSON map of joint names for .bvh files of an unknown skeleton");
    v.number("unit", unit, 0, 1e6,
             "metres per unit of the files, where lengths have one; 0: as found from the figure");
    v.boolean("keep_path", keep_path,
              "keep the root's own path; otherwise it is scaled by the length of the legs");
    v.boolean(
        "fill_gaps", fill_gaps,
        "interpolate values that are nan for up to a second; otherwise such a file is refused");
    v.text("body", body, "SMPL model file: joints of the clips' own shapes");
    v.boolean("align_floor", align_floor, "move each clip so that its feet stand at height 0");
    v.text("label_from_dir", label_from_dir, "the folder of a file is its value of this label");
    v.text("label_regex", label_regex,
           "regular expression with named groups, (?<style>[a-z]+), each a label; searched in the "
           "file's "
           "name, or in its path from SRC on if it contains a '/'");
    v.text("label_csv", label_csv,
           "table with a header; the column 'file' (or 'name') holds names or ends of paths, the "
           "others "
           "are labels");
    v.texts("csv_labels", csv_labels,
            "columns of the table to take as labels, or 'none' (default: all)");
    v.text("csv_fps", csv_fps, "column of the table with the true frames per second");
    v.text("csv_drop_first", csv_drop_first,
           "column of the table with the leading frames to leave out");
    v.text(
        "group", group,
        "clips that stay together in a split: a regular expression whose groups, joined, name the "
        "group of a file, or a table with the columns 'file' and 'group'");
    v.text("split", split, "shares of train,validation,test");
    v.texts("split_list", split_list,
            "SPLIT=FILE: the clips named in FILE, one a line, are in SPLIT");
    v.texts("stratify", stratify, "labels whose every value gets its share of each split");
    v.integer("seed", seed, 0, std::int64_t{1} << 53, "another seed gives other splits");
  }
};

}  // namespace mocaplm
