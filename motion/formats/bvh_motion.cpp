// "Frames: N", "Frame Time: T" and the numbers, which are nearly all of the file: one by one,
// straight from the buffer. Whatever is unusual is looked at where the plain way ends.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/bvh_frame_rate.h"
#include "motion/formats/bvh_gaps.h"
#include "motion/formats/bvh_number.h"
#include "motion/formats/bvh_sections.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxBvhFrames = 1000000;
constexpr std::size_t kMaxBvhValues = std::size_t{64} << 20;  // 512 MiB of doubles

std::string count_of(std::size_t number, const std::string& what) {
  return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

class MotionParser {
 public:
  MotionParser(BvhCursor& cursor, Bvh& bvh, const BvhTextOptions& options)
      : in_(cursor), bvh_(bvh), options_(options) {
    for (const BvhJoint& joint : bvh.joints) channels_ += joint.channels.size();
  }

  void parse() {
    header();
    values();
    if (gaps_ == 0) return;
    fill_gaps(bvh_, bvh_.fps, in_.file);
    bvh_.remarks.push_back({"gaps filled", count_of(gaps_, "value") + " that " +
                                               (gaps_ == 1 ? "is" : "are") +
                                               " no number, the first in " + first_gap_ + ", " +
                                               (gaps_ == 1 ? "is" : "are") + " interpolated"});
  }

 private:
  void header() {
    if (!keyword("Frames")) in_.unexpected(in_.word(), "Frames:");
    announced_ = in_.count("the number of frames", kMaxBvhFrames);
    if (keyword("FrameTime"))
      frame_time();
    else
      no_frame_time();
  }

  // Moves past "Frame Time:", written with or without blanks and colon, in any case; false and
  // unmoved where something else stands.
  bool keyword(std::string_view letters) {
    in_.skip_space();
    const char* at = in_.at;
    for (const char letter : letters) {
      while (at < in_.end && at > in_.at && (*at == ' ' || *at == '\t')) ++at;
      if (at == in_.end || !same_word({at, 1}, {&letter, 1})) return false;
      ++at;
    }
    if (at < in_.end && *at != ':' && !is_bvh_space(*at)) return false;
    while (at < in_.end && (*at == ' ' || *at == '\t')) ++at;
    if (at < in_.end && *at == ':') ++at;
    in_.last = in_.at;
    in_.at = at;
    return true;
  }

  void frame_time() {
    while (in_.at < in_.end && (*in_.at == ' ' || *in_.at == '\t')) ++in_.at;
    if (in_.at == in_.end || is_bvh_space(*in_.at)) return no_frame_time();
    const std::string_view digits = in_.word();
    if (options_.fps) {
      bvh_.fps = *options_.fps;
      bvh_.frame_time = 1 / bvh_.fps;
      return;
    }
    bvh_.frame_time = in_.number_of(digits, "the frame time in seconds");
    if (!(bvh_.frame_time >= 1e-4 && bvh_.frame_time <= 1e6))
      in_.fail(in_.last, "frame time " + shown(digits) +
                             ", expected seconds from 0.0001 to 1000000; if the true rate is "
                             "known, give it (--source-fps, at import --fps)");
    const FrameRate rate = frame_rate(bvh_.frame_time, digits);
    bvh_.fps = rate.fps;
    if (rate.guessed)
      bvh_.remarks.push_back(
          {"frame time rounded", "frame time " + std::string(digits) + " read as " +
                                     format_number(rate.fps) + " frames a second (its digits are " +
                                     format_fixed(1 / bvh_.frame_time, 2) + ")"});
    if (bvh_.frame_time > 2)
      bvh_.remarks.push_back({"frame time long", "frame time " + std::string(digits) +
                                                     " is read as seconds, though so slow a "
                                                     "recording is rare: if these are "
                                                     "milliseconds or frames a second, give the "
                                                     "rate"});
  }
  void no_frame_time() {
    if (!options_.fps)
      in_.unexpected(in_.word(),
                     "\"Frame Time:\" with the seconds of a frame (without it give the rate: "
                     "--source-fps, at import --fps)");
    bvh_.fps = *options_.fps;
    bvh_.frame_time = 1 / bvh_.fps;
    bvh_.remarks.push_back({"frame time missing", "has no \"Frame Time:\""});
  }

  void values() {
    in_.skip_space();
    // A digit and a blank for each value: no header asks for more memory than the text has motion.
    const auto left = static_cast<std::size_t>(in_.end - in_.at);
    const std::size_t possible = (left + 1) / (2 * channels_);
    room(std::min(announced_, possible));
    std::size_t frames = read_frames(0);
    in_.skip_space();
    if (frames == room_ && in_.at < in_.end && !cut_line_) {
      const auto lines = static_cast<std::size_t>(std::count(in_.at, in_.end, '\n')) + 1;
      room(frames + std::min({lines, possible, kMaxBvhFrames + 1 - frames}));
      frames = read_frames(frames);
      if (frames > kMaxBvhFrames)
        in_.fail(in_.at, "has more than " + std::to_string(kMaxBvhFrames) + " frames; split it");
    }
    check_end(frames);
    if (frames < room_)
      bvh_.values.conservativeResize(static_cast<Eigen::Index>(frames), Eigen::NoChange);
  }
  void room(std::size_t frames) {
    if (frames * channels_ > kMaxBvhValues)
      in_.fail(in_.at, "too much motion for one file; split it");
    room_ = frames;
    bvh_.values.conservativeResize(static_cast<Eigen::Index>(frames),
                                   static_cast<Eigen::Index>(channels_));
  }

  // Reads frames from `first` on until the text or the room ends; returns how many there are now.
  std::size_t read_frames(std::size_t first) {
    const std::size_t channels = channels_;
    const char *at = in_.at, *const end = in_.end;
    double* value = bvh_.values.data() + first * channels;
    for (std::size_t t = first; t < room_; ++t) {
      while (at < end && is_bvh_space(*at)) ++at;
      in_.at = at;
      if (at == end) return t;
      for (std::size_t c = 0; c < channels; ++c, ++value) {
        while (at < end && (*at == ' ' || *at == '\t')) ++at;
        const char* stop = parse_number(at, end, *value);
        if (stop == at || (stop < end && !is_bvh_space(*stop)) ||
            !(std::abs(*value) <= kAbsurdBvhValue)) {
          in_.at = at;
          stop = odd_value(t, c);
          if (stop == nullptr) return t;
          *value = std::numeric_limits<double>::quiet_NaN();
        }
        at = stop;
      }
      while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
      in_.at = at;
      if (at < end && *at != '\n')
        throw DataError(place(t), "has more than the " + std::to_string(channels) +
                                      " values that the hierarchy's channels ask for");
    }
    return room_;
  }

  // What stands where no value could be read: the end of a gap that is to be filled, or null where
  // the text ends in the middle of this frame. Throws for all else.
  const char* odd_value(std::size_t frame, std::size_t channel) {
    const char* stop = in_.at;
    while (stop < in_.end && !is_bvh_space(*stop)) ++stop;
    const std::string_view found(in_.at, static_cast<std::size_t>(stop - in_.at));
    const char* next = stop;
    while (next < in_.end && is_bvh_space(*next)) ++next;
    // The text ends between two values, or perhaps within one ("-", "1e").
    if (next == in_.end && frame > 0 &&
        (found.empty() ||
         (stop == in_.end && found.find_first_not_of("+-.0123456789eE") == found.npos))) {
      cut_line_ = true;
      cut_frame_ = frame;
      cut_values_ = channel;
      return nullptr;
    }
    if (found.empty())
      throw DataError(place(frame), "the line ends after " + std::to_string(channel) + " of " +
                                        count_of(channels_, "value"));
    const std::string where = joint_and_channel(channel);
    if (is_gap(found)) {
      if (options_.fill_gaps) {
        if (gaps_++ == 0) first_gap_ = "frame " + std::to_string(frame) + where;
        return stop;
      }
      throw DataError(place(frame, where),
                      "found " + shown(found) +
                          ", which is no number: the recording has a gap there; --fill-gaps "
                          "interpolates gaps of up to one second");
    }
    if (channel == 0 && frame >= announced_ &&
        !std::isdigit(static_cast<unsigned char>(found.back())))
      in_.fail(in_.at, "goes on after the " + std::to_string(announced_) +
                           " frames that \"Frames:\" announces, with " + shown(found));
    std::string hint;
    if (found.find(',') != found.npos)
      hint = "; numbers are written with a point, and blanks stand between them";
    throw DataError(place(frame, where), "found " + shown(found) +
                                             ", expected a finite number within +-" +
                                             format_number(kAbsurdBvhValue) + hint);
  }

  // What a last line or a header that do not fit mean for the `frames` that were read.
  void check_end(std::size_t frames) {
    const std::string there = count_of(frames, "whole frame");
    if (frames == 0) in_.fail(in_.at, "has no frames");
    const std::size_t missing = announced_ > frames ? announced_ - frames : 0;
    const bool few = missing <= std::max<std::size_t>(3, announced_ / 100);
    const bool cut = cut_line_ || (missing > 0 && in_.end[-1] != '\n');
    const std::string last_line = "the last line ends after " + std::to_string(cut_values_) +
                                  " of " + count_of(channels_, "value");
    if (cut && !few)
      throw DataError(
          place(cut_line_ ? cut_frame_ : frames - 1),
          "the file is cut short: " + (cut_line_ ? last_line : std::string("it ends here")) +
              ", and " + there + " of " + std::to_string(announced_) +
              " are there; fetch or export it again");
    if (cut_line_)
      bvh_.remarks.push_back({"last line cut short", last_line + " and is left out; " + there +
                                                         (frames == 1 ? " is" : " are") + " read"});
    if (frames != announced_)
      bvh_.remarks.push_back(
          {"frames announced", "\"Frames:\" announces " + std::to_string(announced_) + ", " +
                                   there + (frames == 1 ? " is" : " are") + " there and read" +
                                   (few ? "" : "; the rest may be lost")});
  }

  Place place(std::size_t frame, const std::string& more = "") const {
    return {in_.file,
            "line " + std::to_string(in_.line(in_.at)) + ", frame " + std::to_string(frame) + more};
  }
  std::string joint_and_channel(std::size_t channel) const {
    for (const BvhJoint& joint : bvh_.joints) {
      const auto first = static_cast<std::size_t>(joint.first_channel);
      if (channel < first || channel >= first + joint.channels.size()) continue;
      return ", joint " + joint.name + ", " +
             bvh_channel_names()[static_cast<std::size_t>(joint.channels[channel - first])];
    }
    return "";
  }

  BvhCursor& in_;
  Bvh& bvh_;
  const BvhTextOptions& options_;
  std::size_t channels_ = 0, announced_ = 0, room_ = 0;
  bool cut_line_ = false;  // the last line is not whole
  std::size_t cut_frame_ = 0, cut_values_ = 0;
  std::size_t gaps_ = 0;
  std::string first_gap_;
};

}  // namespace

void parse_motion(BvhCursor& cursor, Bvh& bvh, const BvhTextOptions& options) {
  MotionParser(cursor, bvh, options).parse();
}

}  // namespace mocaplm
