// What is told while dances are generated: the progress bar, and each frame as a line of JSON for
// whoever shows or plays them at once.
#pragma once

#include <fstream>
#include <memory>
#include <string>

#include "common/progress.h"
#include "generate/generator.h"

namespace mocaplm {

class FrameStream {
 public:
  // `file` gets one line a frame, {"dance", "frame", "seconds", "trans", "poses"}; "-" is standard
  // output, empty none. Throws DataError when it cannot be written.
  FrameStream(double fps, std::size_t dances, const std::string& file = "");

  // Frames go straight into the file, so nothing that is there may be in their way; a pipe may.
  // Throws UsageError for a file that exists, DataError for one that cannot be written.
  static void check(const std::string& file);

  void tell(const GeneratedFrame& frame);
  void finish();

 private:
  std::string note() const;

  double fps_;
  std::size_t dances_, done_ = 0;
  std::string place_;
  std::ofstream file_;
  std::ostream* out_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::unique_ptr<Progress> bar_;  // made when the first frame tells how many there will be
};

}  // namespace mocaplm
