// What a tokenizer's words cost and lose: the columns of the thesis's Tables 4.1 and 4.2.
#pragma once

#include <cstdint>
#include <string>

#include "common/table.h"
#include "tokenizer/any_tokenizer.h"

namespace mocaplm {

// Sum and largest of a quantity.
struct Tally {
  double sum = 0, max = 0;
  std::int64_t count = 0;
  void add(double value) {
    sum += value;
    max = std::max(max, value);
    ++count;
  }
  double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

// Over clips, all at the tokenizer's rate.
struct WordMeasure {
  double fps = 0;
  int word_frames = 1;
  bool root = false;
  std::int64_t clips = 0, frames = 0, words = 0;
  std::int64_t characters = 0;        // spaces not counted
  std::int64_t longest = 0;           // characters of the longest word
  std::int64_t text_bytes = 0;        // UTF-8, with spaces
  std::int64_t dictionary_bytes = 0;  // of the alphabet, or of the texts of all pieces
  // Pieces that the text is made of, each word's space in its last one; 0: no pieces were learnt.
  std::int64_t pieces = 0;
  // Equation 4.7, arccos(a b / |a||b|), radians: of each joint's rotation vector, and of the vector
  // of all of a frame. Where both vectors are zero (below 1e-9) it is 0, where one is, pi / 2.
  Tally joint_vectors, frame_vectors;
  Tally geodesic;  // of each joint's rotation, radians
  Tally position;  // of each of the 24 joints, cm; joints that are not told are where they were
  // How the error changes from frame to frame, sqrt(mean square over channels) in radians: across
  // the border of two words, and inside words. Alike where no border is seen.
  Tally border_jump, inside_jump;

  // Tokens of a word, its separator not counted (it is part of its last piece).
  double word_length() const { return ratio(pieces > 0 ? pieces : characters, words); }
  double seconds_a_word() const { return word_frames / fps; }
  // The thesis's: tokens / average word length * length of a word.
  double seconds_in(double tokens) const { return tokens / word_length() * seconds_a_word(); }
  // Of these very clips: spaces and what fills their last words up count, too.
  double seconds_in_fact(double tokens) const { return tokens * ratio(frames, units()) / fps; }
  // The thesis's: bytes of the SMPL values (72, with the root 75, of 8 bytes a frame) over the
  // number of characters (or pieces) and the bytes of the dictionary.
  double compression() const {
    return 8.0 * (root ? 75 : 72) * ratio(frames, units() + dictionary_bytes);
  }
  double seam() const {
    return inside_jump.mean() > 0 ? border_jump.mean() / inside_jump.mean() : 0;
  }

 private:
  std::int64_t units() const { return pieces > 0 ? pieces : characters + words; }
  static double ratio(std::int64_t a, std::int64_t b) {
    return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0;
  }
};

WordMeasure start_measure(const AnyTokenizer& tokenizer);
// Encodes and decodes a clip, adds what that cost and lost, and returns the tokens.
TokenStream measure_clip(const AnyTokenizer& tokenizer, const Clip& clip, WordMeasure& measure);

// One row a quantity.
Table word_table(const WordMeasure& measure, const std::string& title,
                 const std::string& fingerprint);

// Equation 4.7 of two vectors, as WordMeasure tells it.
double vector_angle(const Eigen::Ref<const Eigen::VectorXd>& a,
                    const Eigen::Ref<const Eigen::VectorXd>& b);

}  // namespace mocaplm
