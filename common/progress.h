// One progress bar for all long work: a moving line with rate and time left on a terminal, and a
// plain line every `plain_seconds` elsewhere (a log file never sees a carriage return, nor does a
// terminal that cannot go back in a line). Writes to stderr.
#pragma once

#include <chrono>
#include <string>

namespace mocaplm {

class Progress {
 public:
  // `unit` is what is counted: "clips", "steps", "frames". A total of 0 means it is not known.
  Progress(std::string what, std::size_t total, std::string unit, double plain_seconds = 10);
  ~Progress();

  // Work that was done before this bar began, by a run that goes on: it is no part of the rate.
  void start_from(std::size_t done) { done_ = before_ = done; }
  // `share`, in [0, 1], tells how far the work is where the units do not (a run that ends by the
  // clock): bar and time left then follow it, and the total is not shown.
  void update(std::size_t done, const std::string& note = "", double share = -1);
  void add(const std::string& note = "") { update(done_ + 1, note); }
  // Prints a line of its own above the bar.
  void print(const std::string& line);
  void finish(const std::string& note = "");

 private:
  std::string line(const std::string& note) const;
  double elapsed() const;
  double seconds_left(double rate) const;
  void show(const std::string& text, bool final);

  std::string what_, unit_;
  std::size_t total_, done_ = 0, before_ = 0;
  double plain_seconds_, last_ = -1e9;
  double share_ = -1, first_share_ = -1, first_share_at_ = 0;
  bool terminal_, finished_ = false, shown_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace mocaplm
