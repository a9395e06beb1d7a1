#include "common/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "common/text.h"

namespace mocaplm {

namespace {

bool moves_in_a_line() {
  const char* kind = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) != 0 && (kind == nullptr || std::string(kind) != "dumb");
}

// What fits the terminal: a line that wraps could not be taken back.
std::string fitted(const std::string& text) {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return text;
  return text.substr(0, size.ws_col - 1u);
}

}  // namespace

Progress::Progress(std::string what, std::size_t total, std::string unit, double plain_seconds)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      plain_seconds_(plain_seconds),
      terminal_(moves_in_a_line()),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (!finished_ && shown_ && terminal_) std::fputc('\n', stderr);
}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

// Negative where it cannot be told.
double Progress::seconds_left(double rate) const {
  if (share_ >= 0)
    return share_ > first_share_ && share_ < 1
               ? (elapsed() - first_share_at_) * (1 - share_) / (share_ - first_share_)
               : -1;
  return total_ > done_ && done_ > before_ ? static_cast<double>(total_ - done_) / rate : -1;
}

std::string Progress::line(const std::string& note) const {
  const double seconds = std::max(elapsed(), 1e-9);
  const double rate = static_cast<double>(done_ - std::min(before_, done_)) / seconds;
  std::string text = what_ + " ";
  const bool counted = total_ > 0 && share_ < 0;
  if (terminal_ && (counted || share_ >= 0)) {
    const int width = 24;
    const double share =
        counted ? static_cast<double>(done_) / static_cast<double>(total_) : std::min(share_, 1.0);
    const int full = static_cast<int>(width * share);
    text += "[" + std::string(full, '#') + std::string(width - full, '.') + "] ";
  }
  text += std::to_string(done_) + (counted ? "/" + std::to_string(total_) : "") + " " + unit_;
  text += ", " +
          format_number(rate < 100 ? static_cast<double>(static_cast<long>(rate * 100)) / 100
                                   : static_cast<double>(static_cast<long>(rate))) +
          "/s";
  const double left = seconds_left(rate);
  text += ", " + (left >= 0 ? format_duration(left) + " left" : format_duration(seconds));
  if (!note.empty()) text += " | " + note;
  return text;
}

void Progress::show(const std::string& text, bool final) {
  shown_ = true;
  if (terminal_)
    std::fprintf(stderr, "\r\033[K%s%s", final ? text.c_str() : fitted(text).c_str(),
                 final ? "\n" : "");
  else
    std::fprintf(stderr, "%s\n", text.c_str());
  std::fflush(stderr);
}

void Progress::update(std::size_t done, const std::string& note, double share) {
  done_ = total_ > 0 ? std::min(done, total_) : done;
  share_ = share;
  const double now = elapsed();
  if (share_ >= 0 && first_share_ < 0) {
    first_share_ = share_;
    first_share_at_ = now;
  }
  if (now - last_ < (terminal_ ? 0.1 : plain_seconds_)) return;
  // A plain log starts with a first report after its interval, not with an empty one.
  if (!terminal_ && last_ < 0 && now < plain_seconds_) return;
  last_ = now;
  show(line(note), false);
}

void Progress::print(const std::string& text) {
  std::fprintf(stderr, "%s%s\n", terminal_ && shown_ ? "\r\033[K" : "", text.c_str());
  std::fflush(stderr);
}

void Progress::finish(const std::string& note) {
  if (finished_) return;
  finished_ = true;
  show(line(note), true);
}

}  // namespace mocaplm
