// A text corpus: a UTF-8 file with one clip a line, its frames (or tiles) words, a character a
// value, separated by one space. Beside NAME.txt lies NAME.clips.json, which tells what each line
// is:
//
//   {"format": "mocaplm corpus", "version": 1, "tokenizer": "<fingerprint>",
//    "clips": [{"line": 1, "name": "walk", "frames": 85, "start": [0, 0, 0], "labels": {"style":
//    "happy"}}]}
//
// The text alone can be read too (written by another program, say): its clips are then named
// line_1, ...
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tokenizer/any_tokenizer.h"

namespace mocaplm {

struct CorpusClip {
  std::string name;
  Labels labels;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  // the root before the first step, metres
  std::vector<std::int32_t> ids;                    // whole words, a separator after each
  std::int64_t frames = 0;  // that the words tell, the last one perhaps not all; 0: all of theirs
};

// NAME.clips.json for NAME.txt.
std::filesystem::path corpus_index_path(const std::filesystem::path& corpus);

// The clip's line, without the newline and without a space at the end.
std::string corpus_line(const AnyTokenizer& tokenizer, const std::vector<std::int32_t>& ids);
// Its reverse; `line` is said in errors, which name the character, or the frame and channel.
std::vector<std::int32_t> parse_corpus_line(const AnyTokenizer& tokenizer, const std::string& text,
                                            const std::string& file, std::size_t line);

void write_corpus(const std::filesystem::path& path, const AnyTokenizer& tokenizer,
                  const std::vector<CorpusClip>& clips);
// Throws DataError naming line and place: characters that are no bins, words of another length, an
// index of another tokenizer or with another number of lines, names that are not plain file names
// or come twice.
std::vector<CorpusClip> read_corpus(const std::filesystem::path& path,
                                    const AnyTokenizer& tokenizer);

// The same for a tokenizer of frames.
inline std::string corpus_line(const Tokenizer& tokenizer, const std::vector<std::int32_t>& ids) {
  return corpus_line(FrameWords(tokenizer), ids);
}
inline std::vector<std::int32_t> parse_corpus_line(const Tokenizer& tokenizer,
                                                   const std::string& text, const std::string& file,
                                                   std::size_t line) {
  return parse_corpus_line(FrameWords(tokenizer), text, file, line);
}
inline void write_corpus(const std::filesystem::path& path, const Tokenizer& tokenizer,
                         const std::vector<CorpusClip>& clips) {
  write_corpus(path, FrameWords(tokenizer), clips);
}
inline std::vector<CorpusClip> read_corpus(const std::filesystem::path& path,
                                           const Tokenizer& tokenizer) {
  return read_corpus(path, FrameWords(tokenizer));
}

}  // namespace mocaplm
