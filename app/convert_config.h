// What `mocaplm convert` can be told.
#pragma once

#include "motion/edit.h"

namespace mocaplm {

struct ConvertConfig {
  EditConfig edit;
  std::string to = "auto";
  std::string unit = "cm";

  template <class Visitor>
  void describe(Visitor& v) {
    edit.describe(v);
    v.choice("to", to, {"auto", "npz", "bvh", "glb", "csv"},
             "format of the files that go into a folder; auto: one file, by its ending");
    v.choice("unit", unit, {"cm", "m"}, "unit of a .bvh file's lengths");
  }
};

}  // namespace mocaplm
