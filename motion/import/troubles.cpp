#include "motion/import/troubles.h"

#include <cctype>

namespace mocaplm {

namespace {

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

std::string without(std::string text, const std::string& part) {
  for (std::size_t at = 0; !part.empty() && (at = text.find(part, at)) != std::string::npos;)
    text.erase(at, part.size());
  return text;
}

// The place behind what begins at `at`: a word in quotes, the name of a joint, a number.
std::size_t name_end(const std::string& text, std::size_t at) {
  if (text[at] == '"') {
    const std::size_t close = text.find('"', at + 1);
    return close == std::string::npos ? at : close + 1;
  }
  if (text.compare(at, 6, "joint ") == 0) {
    const std::size_t end = text.find_first_of(",:;", at);
    return end == std::string::npos ? text.size() : end;
  }
  const std::string word = text.substr(at, 9);  // of the channel that a message names
  if (word.size() == 9 && word[0] >= 'X' && word[0] <= 'Z' &&
      (word.compare(1, 8, "rotation") == 0 || word.compare(1, 8, "position") == 0))
    return at + 9;
  if (text[at] == '-' && at + 1 < text.size() && is_digit(text[at + 1])) ++at;
  if (!is_digit(text[at])) return at;
  while (at < text.size() && (is_digit(text[at]) || text[at] == '.')) ++at;
  return at;
}

}  // namespace

std::string kind_of_error(const std::string& message, const std::string& file) {
  const std::string text = without(message, file);
  std::string kind;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = name_end(text, at);
    if (end > at) {
      kind += '#';
      at = end;
    } else {
      kind += text[at++];
    }
  }
  return kind;
}

bool Troubles::add(const FileRemark& trouble) {
  const auto [at, fresh] = index_.emplace(trouble.remark.kind, groups_.size());
  if (fresh) groups_.push_back({trouble, "", 0});
  Group& group = groups_[at->second];
  if (group.files > 0 && group.last_file == trouble.file) return false;
  group.last_file = trouble.file;
  ++group.files;
  return fresh;
}

std::vector<std::string> Troubles::lines() const {
  std::vector<std::string> all;
  for (const Group& group : groups_) {
    const std::string example = group.first.file + ": " + group.first.remark.text;
    all.push_back(group.files == 1 ? example
                                   : std::to_string(group.files) + " files: " +
                                         group.first.remark.kind + "; for example " + example);
  }
  return all;
}

std::vector<std::string> Troubles::error_lines() const {
  std::vector<std::string> all;
  for (const Group& group : groups_)
    all.push_back(group.files == 1
                      ? group.first.remark.text
                      : std::to_string(group.files) + " files for the same reason; for example " +
                            group.first.remark.text);
  return all;
}

}  // namespace mocaplm
