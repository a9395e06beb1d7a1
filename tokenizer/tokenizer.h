// Motion as text (thesis 4.4, 4.5): a frame is a word, each axis-angle component a character, words
// are separated by a space. Uniform bins over [-pi, pi] radians for rotations and over fitted
// ranges for the root's translation, or bins that hold equally many of the values that the fitting
// saw.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/json.h"
#include "motion/clip.h"
#include "tokenizer/bins.h"

namespace mocaplm {

struct TokenizerConfig {
  std::int64_t bins = 360;  // per channel
  // "uniform": bins of one width; "quantile": bins of each channel with equally many values in
  // each; "pooled_quantile": the same, one set of bins for all rotation channels together.
  std::string binning = "uniform";
  double fps = 20;                               // clips are resampled to this rate
  std::vector<std::string> joints = {"thesis"};  // joint or group names, see parse_joints
  // "steps": per frame (left, height, forward): horizontal steps in the dancer's own heading,
  // height absolute; "absolute": trans x, y, z; "none": rotations only.
  std::string root = "steps";

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("bins", bins, 2, 4096, "bins per channel");
    v.choice("binning", binning, {"uniform", "quantile", "pooled_quantile"},
             "bins of equal width, or of equally many values, per channel or for all rotations");
    v.number("fps", fps, 1, 1000, "frames per second of the token stream");
    v.texts("joints", joints, "joints or groups of joints, comma separated");
    v.choice("root", root, {"steps", "absolute", "none"}, "how the root's translation is told");
  }
};

// One sequence of tokens with the place of each in the motion.
struct TokenStream {
  std::vector<std::int32_t> ids;
  std::vector<std::int32_t> frame;    // index of the frame at the tokenizer's rate
  std::vector<std::int32_t> channel;  // 0 .. channels()-1, and channels() for the separator

  std::size_t size() const { return ids.size(); }
  void reserve(std::size_t size) {
    ids.reserve(size);
    frame.reserve(size);
    channel.reserve(size);
  }
  void push(std::int32_t id, std::int32_t at_frame, std::int32_t at_channel) {
    ids.push_back(id);
    frame.push_back(at_frame);
    channel.push_back(at_channel);
  }
};

struct EncodeReport {
  std::int64_t values = 0;   // values looked at
  std::int64_t clamped = 0;  // of them outside the bins' range, set to the nearest bin
  // The farthest outside: rotations in radians, the root in metres.
  double farthest_rotation = 0, farthest_root = 0;

  void add(const EncodeReport& other) {
    values += other.values;
    clamped += other.clamped;
    farthest_rotation = std::max(farthest_rotation, other.farthest_rotation);
    farthest_root = std::max(farthest_root, other.farthest_root);
  }
};

class Tokenizer {
 public:
  // Fixed ids before the bins.
  static constexpr std::int32_t kPad = 0, kMask = 1, kStart = 2, kSeparator = 3, kFirstBin = 4;

  Tokenizer() = default;
  // Fits the root's ranges and quantile bins on `clips` (each at its own rate).
  static Tokenizer fit(const TokenizerConfig& config, const std::vector<Clip>& clips);
  // The same with one clip in memory at a time: `clip(i)` for i in [0, count).
  static Tokenizer fit(const TokenizerConfig& config, std::size_t count,
                       const std::function<Clip(std::size_t)>& clip);

  const TokenizerConfig& config() const { return config_; }
  const std::vector<int>& joints() const { return joints_; }
  int channels() const { return static_cast<int>(low_.size()); }  // 3 per joint, then 3 of the root
  int rotation_channels() const { return 3 * static_cast<int>(joints_.size()); }
  int tokens_per_frame() const { return channels() + 1; }  // with the separator
  int vocabulary() const;                                  // all ids
  int bins() const { return static_cast<int>(config_.bins); }
  // Bins that a channel has: fewer than bins() where the fitting saw fewer different values.
  int channel_bins(int channel) const {
    return fitted_.empty() ? bins() : fitted_bins(channel).count();
  }
  bool is_bin(std::int32_t id) const { return id >= kFirstBin && id < kFirstBin + bins(); }
  // "left_knee.y", "root.forward"; also "separator" for channels().
  std::string channel_name(int channel) const;
  // Joint of a rotation channel, -1 for the root's translation.
  int channel_joint(int channel) const;

  // Condition tokens, appended after the bins in this order; adding keeps all earlier ids, so new
  // values of a label that is not the last one come as a second entry of that label. Known values
  // stay as is.
  void add_label_values(const std::string& label, const std::vector<std::string>& values);
  const std::vector<std::pair<std::string, std::vector<std::string>>>& label_values() const {
    return labels_;
  }
  // Id of a label's value. Throws DataError with the nearest known value.
  std::int32_t label_id(const std::string& label, const std::string& value) const;
  bool knows(const std::string& label, const std::string& value) const;

  // The clip at the tokenizer's rate. Throws DataError for clips that are not sound (check_clip) or
  // too long at that rate (a million frames).
  Clip at_rate(const Clip& clip) const;
  // The same for this tokenizer's eyes: `clip` itself when it has the rate, else `resampled`, in
  // which joints that the tokenizer leaves out are not worked out.
  const Clip& at_rate(const Clip& clip, Clip& resampled) const;
  // (frames, channels) values at the tokenizer's rate: radians (continuous in time, components
  // inside [-pi, pi]) and metres. The clip is resampled when its rate differs.
  Eigen::MatrixXd channel_values(const Clip& clip) const;
  // Its rotation channels alone, (frames, rotation_channels()).
  using Rotations = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rotations rotation_values(const Clip& clip) const;
  TokenStream encode(const Clip& clip, EncodeReport* report = nullptr) const;
  // Throws DataError naming `name`, frame and channel unless these are whole frames of bins, each
  // with its separator.
  void check_frames(const std::vector<std::int32_t>& ids, const std::string& name) const;
  // Bins to motion at the tokenizer's rate. `start` is the root's position before the first step
  // (metres). Joints that the tokenizer leaves out are zero. Throws DataError naming frame and
  // channel when the stream is not whole frames of this tokenizer.
  Clip decode(const std::vector<std::int32_t>& ids, const std::string& name = "",
              const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) const;

  // What a bin decodes to in the channel's unit (its centre, the mean of its values where it was
  // fitted), and the bin of a value (clamped).
  double bin_centre(int channel, int bin) const {
    const auto c = static_cast<std::size_t>(channel);
    if (!fitted_.empty()) return fitted_bins(channel).centre(bin);
    return low_[c] + (high_[c] - low_[c]) * (bin + 0.5) / bins();
  }
  // How far a value lies outside the channel's range, 0 inside: [-pi, pi] or what the fitting saw
  // of a rotation, with a margin of the root.
  double beyond(int channel, double value) const {
    const auto c = static_cast<std::size_t>(channel);
    if (!fitted_.empty() && channel < rotation_channels())
      return fitted_bins(channel).beyond(value);
    return value < low_[c] ? low_[c] - value : value > high_[c] ? value - high_[c] : 0;
  }
  int bin_of(int channel, double value) const {
    const auto c = static_cast<std::size_t>(channel);
    if (!fitted_.empty()) return fitted_bins(channel).of(value);
    const double bin = (value - low_[c]) / (high_[c] - low_[c]) * bins();
    // Not negative, so that the conversion rounds down.
    return static_cast<int>(std::clamp(bin, 0.0, bins() - 1.0));
  }

  // Every bin a printable character (UTF-8); the separator is a space.
  std::string to_text(const std::vector<std::int32_t>& ids) const;
  // Throws DataError naming line (counted from `line`) and character of what is not in the
  // alphabet. A newline is not: a corpus has one clip a line, see tokenizer/corpus.h.
  std::vector<std::int32_t> from_text(const std::string& text, const std::string& name = "text",
                                      std::size_t line = 1) const;

  Json to_json() const;
  static Tokenizer from_json(const Json& json, const std::string& place);
  // The tokenizer of the model in `folder`, whose config repeats `fingerprint`. Throws DataError
  // when it is another one.
  static Tokenizer of_model(const Json& json, const std::string& fingerprint,
                            const std::string& folder);
  void save(const std::filesystem::path& path) const;
  static Tokenizer load(const std::filesystem::path& path);
  // Changes with anything that changes what a token id of a bin means; not with added labels.
  std::string fingerprint() const;

  // What a token is, for messages: "bin 17", "the mask token", "unknown token -3".
  std::string describe(std::int32_t id) const;

 private:
  // Three bin centres: a vector that this tokenizer decoded. It is kept, so that decoded motion is
  // encoded back to the very same tokens even where the choice between equal rotations is close.
  bool is_decoded(const Eigen::Vector3d& v, int first_channel) const;
  // Throws as at_rate does; true when the clip has the tokenizer's rate.
  bool check_rate(const Clip& clip) const;
  // The rotation channels of one frame of a clip at this rate; in `values` are those of the frame
  // before, unless it is the first.
  void next_rotations(const Clip& clip, Eigen::Index frame, std::vector<double>& values) const;
  // The quantile bins of a channel; fitted_ must not be empty.
  const Bins& fitted_bins(int channel) const {
    const int own = channel < rotation_channels() ? 0 : channel - rotation_channels() + 1;
    return fitted_[static_cast<std::size_t>(pooled_ ? own : channel)];
  }
  void fit_ranges(const RowSample& values);
  void fit_bins(const RowSample& values);
  std::string fitted_name(std::size_t index) const;  // whose bins fitted_[index] are
  void read_bins(JsonObject& object);
  void read_ranges(JsonObject& object);
  void read_labels(JsonObject& object);

  TokenizerConfig config_;
  std::vector<int> joints_;
  std::vector<double> low_, high_;  // per channel
  // None with uniform bins; one a channel with quantile; with pooled_quantile the rotations' and
  // one for each channel of the root.
  std::vector<Bins> fitted_;
  bool pooled_ = false;
  std::vector<std::pair<std::string, std::vector<std::string>>> labels_;
};

// The ids of a text of `count` different characters and spaces; see Tokenizer::from_text.
std::vector<std::int32_t> characters_to_ids(const std::string& text, int count,
                                            const std::string& name, std::size_t line);

}  // namespace mocaplm
