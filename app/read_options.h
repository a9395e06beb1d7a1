// What every command that reads motion files can be told about them, declared once.
#pragma once

#include <string>
#include <vector>

#include "app/options.h"
#include "motion/inputs.h"

namespace mocaplm {

// How a command names what it reads, for the help of its arguments.
constexpr const char* kMotionFiles =
    "motion files (.npz, .pkl, .bvh, .fbx, .glb, ...), FILE:from-to for a part (seconds), "
    "FILE#PART of several "
    "people or takes, ";
constexpr const char* kMotionFile =
    "motion file (.npz, .pkl, .bvh, .fbx, .glb, ...), FILE:from-to for a part (seconds), FILE#PART "
    "of several "
    "people or takes, or DATASET#CLIP";

struct ReadOptionSet {
  std::string rate = "--source-fps";  // or "--source-fps,--fps", where --fps is nothing else
  bool unit = true;                   // false where --unit is something else
};

// --source-fps, --up, --unit, --bvh-map, --keep-path, --fill-gaps, --drop-first and --body, in a
// group of their own. What readers remark is kept for print_remarks. `reading` must live as long
// as `app`.
void add_read_options(CLI::App& app, MotionReading& reading, const ReadOptionSet& set = {});

// Their names, for commands that say what goes with what.
const std::vector<std::string>& read_option_names();

// Prints "note: FILE: TEXT." to standard error for what the readers of this command's files took
// for granted, each kind once; `run` calls it at a command's end, however that is.
void print_remarks();

}  // namespace mocaplm
