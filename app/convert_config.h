// What `mocaplm convert` can be told.
#pragma once

#include "motion/edit.h"

namespace mocaplm {

struct ConvertConfig {
  EditConfig edit;
  std::string to = "auto";
  std::string skeleton = "smpl";
  std::string write_unit = "cm";

  template <class Visitor>
  void describe(Visitor& v) {
    edit.describe(v);
    v.choice("to", to, {"auto", "npz", "bvh", "glb", "vrma", "csv"},
             "format of the files that go into a folder; auto: one file, by its ending");
    v.choice("skeleton", skeleton, {"smpl", "mixamo", "unity", "unreal", "vrm", "rokoko", "cmu"},
             "whose joint names, hierarchy and rest pose a written .bvh or .glb has");
    v.choice("write_unit", write_unit, {"cm", "m"}, "unit of the lengths in a written .bvh");
  }
};

}  // namespace mocaplm
