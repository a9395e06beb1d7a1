// Options of commands that read motion files whose format leaves something open.
#pragma once

#include <map>
#include <string>

#include "app/options.h"
#include "motion/formats/formats.h"

namespace mocaplm {

// --up and --bvh-map. `options` must live as long as `app`.
inline void add_read_options(CLI::App& app, ReadOptions& options) {
  app.add_option("--up", options.up, "up axis of the files (default: by their format)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, UpAxis>{
          {"auto", UpAxis::automatic}, {"y", UpAxis::y}, {"z", UpAxis::z}}));
  app.add_option("--bvh-map", options.bvh_map,
                 "JSON map for a BVH skeleton with unknown joint names")
      ->type_name("FILE");
}

}  // namespace mocaplm
