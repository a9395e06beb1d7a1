// Reading BVH text. The hierarchy is parsed word by word; the motion, which is nearly all of the
// file, number by number straight from the buffer.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <unordered_set>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "motion/formats/bvh.h"
#include "motion/formats/bvh_number.h"

namespace mocaplm {

namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;
constexpr std::size_t kMaxJoints = 4096, kMaxDepth = 256, kMaxFrames = 1000000;
constexpr std::size_t kMaxValues = std::size_t{64} << 20;  // 512 MiB of doubles
constexpr double kAbsurd = 1e7;                            // units or degrees

const std::vector<std::string>& channel_names() {
  static const std::vector<std::string> names = {"Xposition", "Yposition", "Zposition",
                                                 "Xrotation", "Yrotation", "Zrotation"};
  return names;
}

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) ==
                  std::tolower(static_cast<unsigned char>(y));
         });
}

// What was found, for a message: short and printable.
std::string shown(std::string_view word) {
  std::string text = "\"";
  for (const char c : word.substr(0, 40)) text += c >= 32 && c < 127 ? c : '?';
  return text + (word.size() > 40 ? "...\"" : "\"");
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& file)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()), file_(file) {}

  Bvh parse() {
    if (end_ - at_ >= 3 && std::string_view(at_, 3) == "\xEF\xBB\xBF") at_ += 3;
    expect("HIERARCHY");
    hierarchy();
    expect("MOTION");
    header();
    motion();
    return std::move(bvh_);
  }

 private:
  [[noreturn]] void fail(const char* at, const std::string& message) const {
    throw DataError(at_line(file_, line(at)), message);
  }
  std::size_t line(const char* at) const {
    return 1 + static_cast<std::size_t>(std::count(begin_, at, '\n'));
  }

  void skip_space() {
    while (at_ < end_ && is_space(*at_)) ++at_;
  }
  // The next word; empty at the end of the file. Braces are words of their own.
  std::string_view word() {
    skip_space();
    word_ = at_;
    if (at_ < end_ && (*at_ == '{' || *at_ == '}')) return {at_++, 1};
    while (at_ < end_ && !is_space(*at_) && *at_ != '{' && *at_ != '}') ++at_;
    return {word_, static_cast<std::size_t>(at_ - word_)};
  }
  [[noreturn]] void unexpected(std::string_view found, const std::string& expected) const {
    fail(word_, (found.empty() ? "the file ends" : "found " + shown(found)) + " where " + expected +
                    " is expected");
  }
  void expect(const char* keyword) {
    const std::string_view found = word();
    if (!same_word(found, keyword)) unexpected(found, keyword);
  }

  double number(const std::string& what) {
    const std::string_view found = word();
    double value = 0;
    const char* stop = parse_number(found.data(), found.data() + found.size(), value);
    if (found.empty() || stop != found.data() + found.size() || !(std::abs(value) <= kAbsurd))
      unexpected(found, what + " (a finite number)");
    return value;
  }
  std::size_t count(const std::string& what, std::size_t max) {
    const std::string_view found = word();
    std::size_t value = 0;
    const auto result = std::from_chars(found.data(), found.data() + found.size(), value);
    if (found.empty() || result.ec != std::errc() || result.ptr != found.data() + found.size() ||
        value > max)
      unexpected(found, what + " (a whole number of at most " + std::to_string(max) + ")");
    return value;
  }
  void hierarchy() {
    expect("ROOT");
    open_joint(-1);
    int current = 0;
    std::size_t depth = 1;
    while (current >= 0) {
      const std::string_view found = word();
      if (same_word(found, "OFFSET")) {
        bvh_.joints[static_cast<std::size_t>(current)].offset = offset();
      } else if (same_word(found, "CHANNELS")) {
        channels(bvh_.joints[static_cast<std::size_t>(current)]);
      } else if (same_word(found, "JOINT")) {
        if (++depth > kMaxDepth)
          fail(word_, "joints are nested more than " + std::to_string(kMaxDepth) + " deep");
        open_joint(current);
        current = static_cast<int>(bvh_.joints.size()) - 1;
      } else if (same_word(found, "End")) {
        end_site(bvh_.joints[static_cast<std::size_t>(current)]);
      } else if (found == "}") {
        current = bvh_.joints[static_cast<std::size_t>(current)].parent;
        --depth;
      } else {
        unexpected(found, "OFFSET, CHANNELS, JOINT, End Site or }");
      }
    }
    number_channels();
  }
  // Columns follow the order of the joints in the text, wherever in a joint's block CHANNELS
  // stands.
  void number_channels() {
    int next = 0;
    for (BvhJoint& joint : bvh_.joints) {
      joint.first_channel = next;
      next += static_cast<int>(joint.channels.size());
    }
    channels_ = static_cast<std::size_t>(next);
    if (next == 0) fail(at_, "no joint has CHANNELS, so there is no motion to read");
  }
  void open_joint(int parent) {
    BvhJoint joint;
    joint.parent = parent;
    joint.name = joint_name();
    if (!names_.insert(joint.name).second)
      fail(word_, "a second joint is named " + shown(joint.name));
    if (bvh_.joints.size() == kMaxJoints)
      fail(word_, "more than " + std::to_string(kMaxJoints) + " joints");
    bvh_.joints.push_back(std::move(joint));
    const std::string_view found = word();
    if (found != "{") unexpected(found, "{");
  }
  // A name is the rest of the line: 3ds Max writes "Bip01 L Thigh".
  std::string joint_name() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
    word_ = at_;
    while (at_ < end_ && *at_ != '\n' && *at_ != '\r' && *at_ != '{' && *at_ != '}') ++at_;
    std::string_view name(word_, static_cast<std::size_t>(at_ - word_));
    while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
    if (name.empty()) unexpected(word(), "the joint's name");
    if (name.size() > 200) fail(word_, "the joint's name is longer than 200 characters");
    return std::string(name);
  }
  Eigen::Vector3d offset() {
    const double x = number("the OFFSET's x"), y = number("the OFFSET's y"),
                 z = number("the OFFSET's z");
    return {x, y, z};
  }
  void channels(BvhJoint& joint) {
    if (!joint.channels.empty()) fail(word_, "joint " + shown(joint.name) + " has CHANNELS twice");
    const std::size_t n = count("the number of CHANNELS", 6);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view found = word();
      const auto& names = channel_names();
      const auto name = std::find_if(names.begin(), names.end(),
                                     [&](const std::string& s) { return same_word(found, s); });
      if (name == names.end()) unexpected(found, "one of " + join(names, ", "));
      const auto channel = static_cast<BvhChannel>(name - names.begin());
      if (std::find(joint.channels.begin(), joint.channels.end(), channel) != joint.channels.end())
        fail(word_, "joint " + shown(joint.name) + " has the channel " + *name + " twice");
      joint.channels.push_back(channel);
    }
  }
  void end_site(BvhJoint& joint) {
    expect("Site");
    std::string_view found = word();
    if (found != "{") unexpected(found, "{");
    if (joint.end_sites.size() == kMaxJoints) fail(word_, "too many End Sites in one joint");
    expect("OFFSET");
    joint.end_sites.push_back(offset());
    found = word();
    if (found != "}") unexpected(found, "}");
  }

  // "Frames: N" and "Frame Time: T"; the colon may stand apart.
  void header() {
    if (word_is("Frames")) expect(":");
    frames_ = count("the number of frames", kMaxFrames);
    if (frames_ == 0) fail(word_, "has no frames");
    expect("Frame");
    if (word_is("Time")) expect(":");
    bvh_.frame_time = number("the frame time in seconds");
    const std::string_view text(word_, static_cast<std::size_t>(at_ - word_));
    if (!(bvh_.frame_time >= 1e-4 && bvh_.frame_time <= 1e6))
      fail(word_, "frame time " + shown(text) + ", expected seconds from 0.0001 to 1000000");
    bvh_.fps = frame_rate(bvh_.frame_time, text);
    const auto left = static_cast<std::size_t>(end_ - at_);
    if (frames_ * channels_ > (left + 1) / 2)  // a digit and a space for each value
      fail(at_, "announces " + std::to_string(frames_) + " frames of " + std::to_string(channels_) +
                    " values, but only " + std::to_string(left) + " bytes follow");
    if (frames_ * channels_ > kMaxValues) fail(at_, "too much motion for one file; split it");
  }
  // Reads `keyword` with or without its colon; true when the colon is still to come.
  bool word_is(const std::string& keyword) {
    const std::string_view found = word();
    if (same_word(found, keyword + ":")) return false;
    if (!same_word(found, keyword)) unexpected(found, keyword + ":");
    return true;
  }
  // 0.0333 and 0.0333333 both mean 30 frames a second: the whole rate (or thousandth, 29.97) whose
  // time is the written one to its last digit.
  static double frame_rate(double time, std::string_view text) {
    const std::size_t point = text.find('.');
    const bool plain = text.find_first_of("eE") == text.npos && point != text.npos;
    const double last = plain ? std::pow(10, -static_cast<double>(text.size() - point - 1)) : 0;
    const double rate = 1 / time, whole = std::round(rate), fine = std::round(rate * 1000) / 1000;
    if (whole > 0 && std::abs(1 / whole - time) <= std::max(last, 1e-9 * time) &&
        std::abs(whole - rate) < 2e-3 * rate)
      return whole;
    return std::abs(fine - rate) <= 1e-9 * rate ? fine : rate;
  }

  void motion() {
    bvh_.values.resize(static_cast<Eigen::Index>(frames_), static_cast<Eigen::Index>(channels_));
    double* value = bvh_.values.data();
    for (std::size_t t = 0; t < frames_; ++t) {
      skip_space();
      for (std::size_t c = 0; c < channels_; ++c, ++value) {
        while (at_ < end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
        const char* stop = parse_number(at_, end_, *value);
        if (stop == at_ || (stop < end_ && !is_space(*stop)) || !(std::abs(*value) <= kAbsurd))
          bad_value(t, c);
        at_ = stop;
      }
      while (at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r')) ++at_;
      if (at_ < end_ && *at_ != '\n')
        throw DataError(motion_place(t), "has more than the " + std::to_string(channels_) +
                                             " values that the hierarchy's channels ask for");
    }
    skip_space();
    if (at_ < end_)
      fail(at_, "goes on after the " + std::to_string(frames_) +
                    " frames that \"Frames:\" announces; correct that number");
  }
  Place motion_place(std::size_t frame) const {
    return {file_, "line " + std::to_string(line(at_)) + ", frame " + std::to_string(frame)};
  }
  [[noreturn]] void bad_value(std::size_t frame, std::size_t channel) {
    Place place = motion_place(frame);
    const bool line_ends = at_ == end_ || *at_ == '\n' || *at_ == '\r';
    if (at_ == end_ && channel == 0)
      throw DataError(place, "the file ends here, but \"Frames:\" announces " +
                                 std::to_string(frames_) + "; the file is cut short");
    if (line_ends)
      throw DataError(place, std::string(at_ == end_ ? "the file" : "the line") + " ends after " +
                                 std::to_string(channel) + " of " + std::to_string(channels_) +
                                 " values");
    for (const BvhJoint& joint : bvh_.joints) {
      const auto first = static_cast<std::size_t>(joint.first_channel);
      if (channel < first || channel >= first + joint.channels.size()) continue;
      place.where += ", joint " + joint.name + ", " +
                     channel_names()[static_cast<std::size_t>(joint.channels[channel - first])];
    }
    const char* stop = at_;
    while (stop < end_ && !is_space(*stop)) ++stop;
    throw DataError(place, "found " + shown({at_, static_cast<std::size_t>(stop - at_)}) +
                               ", expected a finite number within +-" + format_number(kAbsurd));
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  const char* word_ = begin_;  // where the last word began
  const std::string& file_;
  Bvh bvh_;
  std::unordered_set<std::string> names_;
  std::size_t channels_ = 0, frames_ = 0;
};

}  // namespace

Bvh parse_bvh(std::string_view text, const std::string& name) {
  return Parser(text, name).parse();
}

Bvh read_bvh(const std::filesystem::path& path) {
  return parse_bvh(read_file(path, kMaxBytes), path.string());
}

}  // namespace mocaplm
