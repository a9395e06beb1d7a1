// Options of commands that read motion files whose format leaves something open.
#pragma once

#include <string>

#include "app/options.h"
#include "motion/formats/formats.h"

namespace mocaplm {

// --up, --bvh-map, and the files' own frame rate, whose option has a name for each command: --fps
// may be the rate of what it writes. `options` must live as long as `app`.
inline void add_read_options(CLI::App& app, ReadOptions& options,
                             const std::string& rate = "--source-fps") {
  app.add_option_function<double>(
         rate, [&options](const double& fps) { options.fps = fps; },
         "frame rate of the files, where their own is wrong or missing")
      ->check(CLI::Range(0.001, 10000.0))
      ->check(BindOptions::finite());
  app.add_option_function<std::string>(
         "--up", [&options](const std::string& name) { options.up = up_axis_of(name); },
         "up axis of the files (auto: by their format or their motion)")
      ->check(one_of(up_axis_names()))
      ->default_str("auto");
  app.add_option("--bvh-map", options.bvh_map,
                 "JSON map for a BVH skeleton with unknown joint names")
      ->type_name("FILE");
}

}  // namespace mocaplm
