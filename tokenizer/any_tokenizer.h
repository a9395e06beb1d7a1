// What the tokenizers have in common: a clip becomes words of characters, and words a clip again.
// Corpora, `tokenize` and its report speak to this; models need to know more and take the
// tokenizer itself.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tokenizer/tiles.h"
#include "tokenizer/tokenizer.h"

namespace mocaplm {

class AnyTokenizer {
 public:
  virtual ~AnyTokenizer() = default;

  // The settings of frames, and of tiles (tiles = 0 where frames are words).
  virtual const TokenizerConfig& frames() const = 0;
  virtual TileConfig tiles() const { return {}; }
  virtual const std::vector<int>& joints() const = 0;
  bool tells_root() const { return frames().root != "none"; }
  int word_frames() const { return std::max(1, static_cast<int>(tiles().tiles)); }
  virtual int characters() const = 0;  // different ones, the space not counted

  virtual TokenStream encode(const Clip& clip, EncodeReport* report = nullptr) const = 0;
  // The first `frames` frames of what `ids` tell, all of them when it is 0.
  virtual Clip decode(const std::vector<std::int32_t>& ids, std::int64_t frames,
                      const std::string& name, const Eigen::Vector3d& start) const = 0;
  // Throws DataError naming `name` unless these are whole words; returns their number.
  virtual std::size_t check(const std::vector<std::int32_t>& ids,
                            const std::string& name) const = 0;
  // The rotation vectors that are told, (frames, 3 joints), radians.
  virtual Eigen::MatrixXd rotations(const Clip& clip) const = 0;
  virtual std::string to_text(const std::vector<std::int32_t>& ids) const = 0;
  virtual std::vector<std::int32_t> from_text(const std::string& text, const std::string& name,
                                              std::size_t line) const = 0;
  virtual std::string fingerprint() const = 0;
  virtual Json to_json() const = 0;
};

// What frames and tiles have a tokenizer of their own for, asked in the same words.
template <class Own>
class WordsOf : public AnyTokenizer {
 public:
  explicit WordsOf(Own tokenizer) : tokenizer_(std::move(tokenizer)) {}
  const Own& tokenizer() const { return tokenizer_; }

  const std::vector<int>& joints() const override { return tokenizer_.joints(); }
  TokenStream encode(const Clip& clip, EncodeReport* report) const override {
    return tokenizer_.encode(clip, report);
  }
  std::string to_text(const std::vector<std::int32_t>& ids) const override {
    return tokenizer_.to_text(ids);
  }
  std::vector<std::int32_t> from_text(const std::string& text, const std::string& name,
                                      std::size_t line) const override {
    return tokenizer_.from_text(text, name, line);
  }
  std::string fingerprint() const override { return tokenizer_.fingerprint(); }
  Json to_json() const override { return tokenizer_.to_json(); }

 private:
  Own tokenizer_;
};

class FrameWords : public WordsOf<Tokenizer> {
 public:
  using WordsOf<Tokenizer>::WordsOf;

  const TokenizerConfig& frames() const override { return tokenizer().config(); }
  int characters() const override { return tokenizer().bins(); }
  Clip decode(const std::vector<std::int32_t>& ids, std::int64_t, const std::string& name,
              const Eigen::Vector3d& start) const override {
    return tokenizer().decode(ids, name, start);
  }
  std::size_t check(const std::vector<std::int32_t>& ids, const std::string& name) const override {
    tokenizer().check_frames(ids, name);
    return ids.size() / static_cast<std::size_t>(tokenizer().tokens_per_frame());
  }
  Eigen::MatrixXd rotations(const Clip& clip) const override {
    return tokenizer().rotation_values(clip);
  }
};

class TileWords : public WordsOf<TileTokenizer> {
 public:
  using WordsOf<TileTokenizer>::WordsOf;

  const TokenizerConfig& frames() const override { return tokenizer().frames(); }
  TileConfig tiles() const override { return tokenizer().tiles(); }
  int characters() const override { return tokenizer().characters(); }
  Clip decode(const std::vector<std::int32_t>& ids, std::int64_t frames, const std::string& name,
              const Eigen::Vector3d& start) const override {
    return tokenizer().decode(ids, frames, name, start);
  }
  std::size_t check(const std::vector<std::int32_t>& ids, const std::string& name) const override {
    return tokenizer().check_words(ids, name);
  }
  Eigen::MatrixXd rotations(const Clip& clip) const override {
    return tokenizer().channel_values(clip).leftCols(
        3 * static_cast<Eigen::Index>(tokenizer().joints().size()));
  }
};

// Frame or tile tokenizer, as tiles.tiles says; clip(i) for i in [0, count) is asked for once.
std::unique_ptr<AnyTokenizer> fit_tokenizer(const TokenizerConfig& frames, const TileConfig& tiles,
                                            std::size_t count,
                                            const std::function<Clip(std::size_t)>& clip);
// Whichever the file holds. Throws DataError as their readers do.
std::unique_ptr<AnyTokenizer> load_tokenizer(const std::filesystem::path& path);

}  // namespace mocaplm
