// The thesis's tokenizer in the manner of JPEG (4.4.1): the motion is cut into tiles of some
// frames, each channel of a tile becomes its DCT, the coefficients of least magnitude become zero,
// the others bins. A tile is a word: a character a coefficient, one for a run of zeros; words are
// separated by a space. Before it, if wanted, principal or independent components in place of the
// channels.
//
//   values (T, D) -> components (T, K) -> DCT over each tile (tile, K) -> keep the largest -> bins
//
// Beyond the thesis: tiles may overlap (numeric/dct.h's LapFilter), so that their borders are not
// seen; the coefficients of a tile compete for the places that are kept, all channels together; the
// zeros at the end of a word are not written at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "numeric/components.h"
#include "numeric/dct.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

// Beside TokenizerConfig, whose bins, binning, fps, joints and root count here, too. With
// binning = uniform the bins are of one width around zero; quantile fits a set for each component,
// pooled_quantile one set (the thesis's).
struct TileConfig {
  std::int64_t tiles = 0;         // frames of a tile; 0: no tiles, frames are words
  double keep = 0.1;              // share of a tile's coefficients that is kept, by magnitude
  double threshold = 0;           // those below it are not kept either (radians, metres)
  std::int64_t pca = 0, ica = 0;  // components, 0 for none
  bool lapped = false;
  std::string scan =
      "frequency";          // a word's order: frequency by frequency, or component by component
  std::int64_t runs = 256;  // the longest run of zeros with a character of its own

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("tiles", tiles, 0, 4096,
              "frames of a DCT tile, which is a word; 0: frames are words");
    v.number("keep", keep, 0, 1, "share of a tile's DCT coefficients that is kept, by magnitude");
    v.number("threshold", threshold, 0, 1000, "DCT coefficients below it are not kept either");
    v.integer("pca", pca, 0, 75, "principal components in place of the channels, 0 for none");
    v.integer("ica", ica, 0, 75, "independent components in place of the channels, 0 for none");
    v.boolean("lapped", lapped, "tiles that overlap, so that their borders are not seen");
    v.choice("scan", scan, {"frequency", "component"}, "order of the coefficients in a word");
    v.integer("runs", runs, 1, 4094, "longest run of zeros with a character of its own");
  }
};

class TileTokenizer {
 public:
  static constexpr std::int32_t kSeparator = Tokenizer::kSeparator,
                                kFirstBin = Tokenizer::kFirstBin;
  static constexpr const char* kFormat = "mocaplm tile tokenizer";

  // Fits components and bins on clips given one at a time: clip(i) for i in [0, count); their
  // values are held in memory. Throws UsageError for settings that cannot be (root = steps, both
  // pca and ica, more components than channels, more characters than the alphabet has) and for no
  // clips.
  static TileTokenizer fit(const TokenizerConfig& frames, const TileConfig& tiles,
                           std::size_t count, const std::function<Clip(std::size_t)>& clip);
  // The same on what `channel_values` gave of each clip.
  static TileTokenizer fit_values(const TokenizerConfig& frames, const TileConfig& tiles,
                                  const std::vector<Eigen::MatrixXd>& values);

  const TokenizerConfig& frames() const { return frames_; }
  const TileConfig& tiles() const { return tiles_; }
  const std::vector<int>& joints() const { return joints_; }
  bool tells_root() const { return frames_.root != "none"; }
  int channels() const { return 3 * static_cast<int>(joints_.size()) + (tells_root() ? 3 : 0); }
  int components() const { return static_cast<int>(basis_.count()); }
  int coefficients() const { return static_cast<int>(tiles_.tiles) * components(); }  // of a tile
  int bins() const { return static_cast<int>(frames_.bins); }
  int vocabulary() const { return kFirstBin + characters(); }
  int characters() const { return bins() + static_cast<int>(tiles_.runs); }  // bins, then runs

  // (frames, channels) at the tokenizer's rate: rotation vectors that follow each other (their
  // components may leave [-pi, pi]), and the root: x and z from the first frame on, y.
  Eigen::MatrixXd channel_values(const Clip& clip) const;
  static Eigen::MatrixXd channel_values(const TokenizerConfig& frames,
                                        const std::vector<int>& joints, const Clip& clip);
  // Its reverse. `start` is where the root begins.
  Clip motion(const Eigen::MatrixXd& values, const std::string& name,
              const Eigen::Vector3d& start) const;

  // frame: the tile's first; channel: the coefficient in the word's order, coefficients() for the
  // separator. The last tile is filled up with the last frame.
  TokenStream encode(const Clip& clip, EncodeReport* report = nullptr) const;
  TokenStream encode_values(const Eigen::MatrixXd& values, EncodeReport* report = nullptr) const;
  // (tiles * tile, channels). Throws DataError naming `name`, word and character unless these are
  // whole words: bins and runs, no more coefficients than a tile has, a separator after each.
  Eigen::MatrixXd decode_values(const std::vector<std::int32_t>& ids,
                                const std::string& name) const;
  // The first `frames` frames of it, all of them when it is 0.
  Clip decode(const std::vector<std::int32_t>& ids, std::int64_t frames = 0,
              const std::string& name = "",
              const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) const;
  std::size_t check_words(const std::vector<std::int32_t>& ids, const std::string& name) const;

  std::string to_text(const std::vector<std::int32_t>& ids) const;
  // Throws DataError as Tokenizer::from_text does.
  std::vector<std::int32_t> from_text(const std::string& text, const std::string& name = "text",
                                      std::size_t line = 1) const;

  Json to_json() const;
  static TileTokenizer from_json(const Json& json, const std::string& place);
  std::string fingerprint() const;

 private:
  TileTokenizer(const TokenizerConfig& frames, const TileConfig& tiles);  // checked, not fitted
  void make_transforms();
  // Tiles' DCT, all below each other: (whole tiles, K).
  Eigen::MatrixXd transform(const Eigen::MatrixXd& values) const;
  Eigen::MatrixXd inverse(Eigen::MatrixXd coefficients) const;
  // Which coefficients of a tile are kept: those from this magnitude on.
  double least_kept(const Eigen::Ref<const Eigen::MatrixXd>& tile) const;
  void fit_components(const std::vector<Eigen::MatrixXd>& values);
  void fit_bins(const std::vector<Eigen::MatrixXd>& values);
  const Bins& bins_of(Eigen::Index component) const {
    return fitted_[fitted_.size() == 1 ? 0 : static_cast<std::size_t>(component)];
  }
  // (frequency, component) of a place in a word.
  std::pair<Eigen::Index, Eigen::Index> place(Eigen::Index at) const {
    const Eigen::Index k = components(), n = tiles_.tiles;
    return tiles_.scan == "frequency" ? std::make_pair(at / k, at % k)
                                      : std::make_pair(at % n, at / n);
  }
  void write_word(const Eigen::Ref<const Eigen::MatrixXd>& tile, std::int32_t frame,
                  TokenStream& stream, EncodeReport& report) const;

  TokenizerConfig frames_;
  TileConfig tiles_;
  std::vector<int> joints_;
  Components basis_;
  std::vector<Bins> fitted_;  // one set, or one a component
  Eigen::MatrixXd dct_;
  LapFilter lap_{1};
};

}  // namespace mocaplm
