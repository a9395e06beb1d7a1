#include "app/frame_stream.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"

namespace fs = std::filesystem;

namespace mocaplm {

FrameStream::FrameStream(double fps, std::size_t dances, const std::string& file)
    : fps_(fps), dances_(dances), place_(file) {
  if (file == "-") out_ = &std::cout;
  if (file.empty() || file == "-") return;
  file_.open(file, std::ios::binary);
  if (!file_) throw DataError(in_file(file), "cannot be written");
  out_ = &file_;
}

void FrameStream::check(const std::string& file) {
  if (file == "-" || fs::is_fifo(file) || fs::is_character_file(file)) return;
  if (fs::exists(file))
    throw UsageError("--stream: " + file + " is already there; give a new file, a pipe, or -");
  check_writable(file);
}

std::string FrameStream::note() const {
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
  char text[60];
  std::snprintf(text, sizeof text, "%.2f x real time",
                static_cast<double>(done_) / fps_ / std::max(seconds.count(), 1e-9));
  return text;
}

void FrameStream::tell(const GeneratedFrame& frame) {
  if (!bar_) bar_ = std::make_unique<Progress>("generate", frame.frames * dances_, "frames");
  bar_->update(++done_, note());
  if (out_ == nullptr) return;
  const auto values = [](const auto& row) {
    return std::vector<double>(row.data(), row.data() + row.size());
  };
  const Eigen::RowVectorXd poses = frame.pose.poses.row(0), trans = frame.pose.trans.row(0);
  const Json line = {{"dance", frame.dance},
                     {"frame", frame.index},
                     {"seconds", static_cast<double>(frame.index) / fps_},
                     {"trans", values(trans)},
                     {"poses", values(poses)}};
  *out_ << line.dump() << '\n' << std::flush;
  if (!*out_) throw DataError(in_file(place_), "cannot be written");
}

void FrameStream::finish() {
  if (bar_) bar_->finish(note());
}

}  // namespace mocaplm
