// Motion files of one format into files of another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/convert_config.h"
#include "common/table.h"
#include "motion/formats/formats.h"
#include "motion/reading.h"

namespace mocaplm {

struct ConvertJob {
  std::vector<std::string> inputs;  // files, parts of them, dataset folders (motion/inputs.h)
  std::vector<std::string> clips;   // of the dataset folders; none: all
  std::filesystem::path out;        // one file, by its ending, or with config.to a folder
  std::filesystem::path character;  // a .glb whose figure gets the motions, or empty
  MotionReading read;
  ConvertConfig config;
  std::int64_t threads = 0;     // 0: all cores
  std::filesystem::path table;  // which the caller writes, or empty: no motion may be there
};

// Writes them and says what was written. Throws UsageError before any work when the files cannot
// all be written as asked (an unknown ending, several into one, one over a motion that is read),
// and as reading and writing do; then the files before the broken one are there.
Table convert_files(const ConvertJob& job);

}  // namespace mocaplm
