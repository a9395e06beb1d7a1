// Tiles as words: coefficients to ids and characters, and back.
#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "tokenizer/alphabet.h"
#include "tokenizer/tiles.h"

namespace mocaplm {

void TileTokenizer::write_word(const Eigen::Ref<const Eigen::MatrixXd>& tile, std::int32_t frame,
                               TokenStream& stream, EncodeReport& report) const {
  const double least = least_kept(tile);
  const auto longest = static_cast<std::int32_t>(tiles_.runs);
  std::int32_t zeros = 0;
  bool empty = true;
  const auto run = [&](std::int32_t at) {
    for (; zeros > 0; empty = false) {
      const std::int32_t length = std::min(zeros, longest);
      stream.push(kFirstBin + bins() + length - 1, frame, at - zeros);
      zeros -= length;
    }
  };
  const auto size = static_cast<std::int32_t>(tile.size());
  for (std::int32_t at = 0; at < size; ++at) {
    const auto [k, c] = place(at);
    const double value = tile(k, c);
    const Bins& set = bins_of(c);
    const int bin = set.of(value);
    ++report.values;
    // A value that zero tells better than its bin is zero.
    if (std::abs(value) < least || std::abs(value) <= std::abs(value - set.centre(bin))) {
      ++zeros;
      continue;
    }
    run(at);
    stream.push(kFirstBin + bin, frame, at);
    empty = false;
  }
  // What is left are zeros: the end of the word says so, but no word is empty.
  zeros = std::min(zeros, 1);
  if (empty) run(1);
  stream.push(kSeparator, frame, size);
}

TokenStream TileTokenizer::encode_values(const Eigen::MatrixXd& values,
                                         EncodeReport* report) const {
  const Eigen::MatrixXd all = transform(values);
  const Eigen::Index n = tiles_.tiles;
  TokenStream stream;
  EncodeReport counted;
  for (Eigen::Index first = 0; first < all.rows(); first += n)
    write_word(all.middleRows(first, n), static_cast<std::int32_t>(first), stream, counted);
  if (report) report->add(counted);
  return stream;
}

TokenStream TileTokenizer::encode(const Clip& clip, EncodeReport* report) const {
  return encode_values(channel_values(clip), report);
}

std::size_t TileTokenizer::check_words(const std::vector<std::int32_t>& ids,
                                       const std::string& name) const {
  std::size_t words = 0, character = 0;
  std::int64_t coefficients = 0;
  const auto refuse = [&](const std::string& message) {
    throw DataError(Place{name, "word " + std::to_string(words + 1) + ", character " +
                                    std::to_string(character + 1)},
                    message);
  };
  if (ids.empty()) throw DataError(in_file(name), "holds no tokens, expected words");
  for (const std::int32_t id : ids) {
    if (id == kSeparator) {
      if (character == 0) refuse("found a separator, expected a tile's coefficients");
      ++words;
      character = 0;
      coefficients = 0;
      continue;
    }
    const std::int32_t bin = id - kFirstBin;
    if (bin < 0 || bin >= characters())
      refuse("found token " + std::to_string(id) + ", expected a bin or a run of zeros");
    coefficients += bin < bins() ? 1 : bin - bins() + 1;
    if (coefficients > this->coefficients())
      refuse("the word tells more than the " + std::to_string(this->coefficients()) +
             " coefficients of a tile");
    ++character;
  }
  if (character > 0) refuse("found the end, expected a separator after the word");
  return words;
}

Eigen::MatrixXd TileTokenizer::decode_values(const std::vector<std::int32_t>& ids,
                                             const std::string& name) const {
  const std::size_t words = check_words(ids, name.empty() ? "token stream" : name);
  const Eigen::Index n = tiles_.tiles;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(words) * n, components());
  Eigen::Index first = 0, at = 0;
  for (const std::int32_t id : ids) {
    const std::int32_t bin = id - kFirstBin;
    if (id == kSeparator) {
      first += n;
      at = 0;
    } else if (bin >= bins()) {
      at += bin - bins() + 1;
    } else {
      const auto [k, c] = place(at++);
      all(first + k, c) = bins_of(c).centre(bin);
    }
  }
  return inverse(std::move(all));
}

Clip TileTokenizer::decode(const std::vector<std::int32_t>& ids, std::int64_t frames,
                           const std::string& name, const Eigen::Vector3d& start) const {
  const Eigen::MatrixXd values = decode_values(ids, name);
  const Eigen::Index count =
      frames > 0 ? std::min<Eigen::Index>(frames, values.rows()) : values.rows();
  return motion(values.topRows(count), name, start);
}

std::string TileTokenizer::to_text(const std::vector<std::int32_t>& ids) const {
  std::string text;
  text.reserve(2 * ids.size());
  for (const std::int32_t id : ids) {
    if (id == kSeparator) {
      text += ' ';
      continue;
    }
    if (id < kFirstBin || id >= vocabulary())
      throw DataError(in_file("token stream"),
                      "found token " + std::to_string(id) + ", which has no character");
    append_utf8(text, bin_character(id - kFirstBin));
  }
  return text;
}

std::vector<std::int32_t> TileTokenizer::from_text(const std::string& text, const std::string& name,
                                                   std::size_t line) const {
  return characters_to_ids(text, characters(), name, line);
}

}  // namespace mocaplm
