// Pictures into the program ffmpeg, which makes films of them.
#pragma once

#include <string>
#include <vector>

#include "render/picture.h"

namespace mocaplm {

// $MOCAPLM_FFMPEG, or ffmpeg on the PATH. Throws UsageError that says what to install.
std::string find_ffmpeg();

// One run of ffmpeg that reads pictures from its standard input.
class Ffmpeg {
 public:
  // `output`: the options after the input. Throws DataError when it cannot be started.
  Ffmpeg(const std::string& program, int width, int height, double fps,
         const std::vector<std::string>& output);
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  // Throws as finish does when the program has ended early.
  void write(const Picture& picture);
  // Waits for its end. Throws DataError with what ffmpeg says when it failed.
  void finish();

 private:
  int wait();

  std::string program_;
  int child_ = -1, to_ = -1, errors_ = -1;  // process, its standard input, its standard error
  void (*old_handler_)(int);                // of SIGPIPE
};

}  // namespace mocaplm
