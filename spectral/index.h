// An index: the feature rows of all windows of a dataset, on disk and mapped into memory.
//
//   bytes 0..31   "mocaplm spectral index 2\n", padded with zeros
//         32..39  where the JSON at the end begins, 40..47 how many bytes it has (little endian)
//         4096    rows     (n, d) f32, each of length 1 (or 0)
//                 sketch   (n, s) f32: s - 1 coordinates and the length of what they leave out
//                 coarse   (n, 16) f32: 15 of these and the length, where there are sketches
//                 lengths  (n)    f32: of the rows as they were
//                 windows  (n)    two u32: clip, first frame at the config's rate
//                 what the features learned (f32), the sketch's basis (d, s - 1)
//                 JSON: settings, n, d, s, clips, fingerprints
//
// The sketch of a row x is (B'x, |x - B B'x|) for orthonormal columns B, so that for unit vectors
// x'y <= sketch(x)'sketch(y): by Cauchy and Schwarz what is left out adds at most the product of
// its lengths, which are rounded up. A coarse sketch is the same with fewer coordinates: the first
// are the leading components, which hold most. A search reads all coarse sketches, the sketches of
// what these cannot rule out, and compares in full what is left.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/dataset.h"
#include "spectral/features.h"
#include "spectral/mapped_file.h"

namespace mocaplm {

// Coordinates of a sketch; rows of up to twice as many dimensions have none and are compared
// directly.
constexpr Eigen::Index kSketch = 64;
constexpr Eigen::Index kCoarse = 16;  // of a coarse one

struct MotionWindow {
  std::uint32_t clip = 0, first = 0;
};

class SpectralIndex {
 public:
  // Opens a file. Throws DataError when it is not an index or not a sound one.
  explicit SpectralIndex(const std::filesystem::path& path);

  const SpectralConfig& config() const { return config_; }
  const FeatureMaker& features() const { return *features_; }
  Eigen::Index size() const { return n_; }
  Eigen::Index dimensions() const { return d_; }
  Eigen::Index sketch_dimensions() const { return s_; }
  Eigen::Map<const Series> rows() const { return {floats(rows_), n_, d_}; }
  Eigen::Map<const Series> sketch() const { return {floats(sketch_), n_, s_}; }
  // (n, kCoarse); empty where there are no sketches.
  Eigen::Map<const Series> coarse() const { return {floats(coarse_), n_, s_ > 0 ? kCoarse : 0}; }
  Eigen::Map<const Eigen::VectorXf> lengths() const { return {floats(lengths_), n_}; }
  MotionWindow window(Eigen::Index row) const;
  // Names of the dataset's clips, in its order; those without windows, too.
  const std::vector<std::string>& clips() const { return clips_; }
  std::int64_t clips_too_short() const { return too_short_; }
  const std::string& fingerprint() const { return fingerprint_; }  // of the dataset

  // The sketches (n, s) of unit rows (n, d).
  Series sketch_of(const Series& rows) const;

 private:
  const float* floats(std::size_t offset) const {
    return reinterpret_cast<const float*>(file_->data() + offset);
  }

  std::shared_ptr<MappedFile> file_;
  SpectralConfig config_;
  std::shared_ptr<FeatureMaker> features_;
  Eigen::Index n_ = 0, d_ = 0, s_ = 0;
  std::size_t rows_ = 0, sketch_ = 0, coarse_ = 0, lengths_ = 0, windows_ = 0;
  Eigen::MatrixXf basis_;  // (d, s - 1)
  std::vector<std::string> clips_;
  std::string fingerprint_;
  std::int64_t too_short_ = 0;
};

// Divides each row by its length, which is returned (n); rows of zeros stay.
Eigen::VectorXf normalise_rows(Series& rows);
// (B'x, |x - B B'x|) of each unit row, the length rounded up by more than single precision loses.
Series make_sketch(const Series& rows, const Eigen::MatrixXf& basis);
// The coarse sketches (n, kCoarse) of sketches (n, kSketch).
Series make_coarse(const Series& sketch);

// Writes an index clip by clip. The rows go to the disk at once; the sketches stay in memory until
// the end (320 bytes a window).
class IndexWriter {
 public:
  // `sample`: windows of some clips, for what features and sketch learn. `path` is written as it is
  // (write_file_with gives a path that may be).
  IndexWriter(const std::filesystem::path& path, const SpectralConfig& config,
              const std::vector<Series>& sample);
  ~IndexWriter();
  const FeatureMaker& features() const;
  // Rows of features() for the windows of the next clip; none for a clip that is too short.
  void add(const std::string& clip, const std::vector<Eigen::Index>& starts, Series rows);
  void finish(const std::string& fingerprint);
  Eigen::Index size() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// What tells one dataset from another: names, files, lengths, rates, sizes and times of the files.
std::string dataset_fingerprint(const Dataset& dataset);
std::string config_fingerprint(const SpectralConfig& config);

// Reads all clips and writes the index. Throws DataError when no clip is as long as a window, and
// for clips that are not sound.
void build_index(const Dataset& dataset, const SpectralConfig& config,
                 const std::filesystem::path& path, std::int64_t threads);

// The index kept in `folder` (empty: the dataset's own) under a name of its settings; it is built
// first where there is none or, in the dataset's folder, where the dataset has changed. `note` says
// what was done. Throws DataError when `folder` holds one of these settings for another dataset.
SpectralIndex index_of(const Dataset& dataset, const SpectralConfig& config,
                       const std::filesystem::path& folder, std::int64_t threads,
                       std::string* note = nullptr);

}  // namespace mocaplm
