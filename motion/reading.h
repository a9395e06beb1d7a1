// How a command reads the motions that it is given, and what it remembers of their readers'
// remarks.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "motion/formats/formats.h"

namespace mocaplm {

// What readers took for granted in all files of a command. May be filled by several threads.
class Remarks {
 public:
  void add(const std::string& file, const std::vector<Remark>& remarks);

  // One for each kind, by the kinds' names: "a.bvh: TEXT.", of several files "12 files, a.bvh among
  // them: TEXT." with the first file's text. What a lone file says of one kind stands in several.
  std::vector<std::string> sentences() const;

 private:
  mutable std::mutex mutex_;
  // kind -> file -> texts
  std::map<std::string, std::map<std::string, std::set<std::string>>> kinds_;
};

struct MotionReading : ReadOptions {
  std::shared_ptr<Remarks> remarks;  // null: nobody wants to hear them
};

// The command line's names of what is not as it is by default: "--source-fps", "--up".
std::vector<std::string> given_options(const ReadOptions& options);

// Throws UsageError, OPTION + `why`, when anything is given.
void refuse_read_options(const ReadOptions& options, const std::string& why);

// Metres per unit, of "m", "cm", "mm", "in", "ft" or a number from 1e-6 to 1e6. Throws UsageError.
double metres_of_unit(const std::string& text);

}  // namespace mocaplm
