#include "motion/mirror.h"

#include <cctype>

#include "motion/skeleton.h"

namespace mocaplm {

namespace {

bool letter(const std::string& text, std::size_t at) {
  return at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) != 0;
}

// Swaps the whole words "left" and "right".
std::string swap_sides(const std::string& text) {
  std::string out;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (letter(text, end)) ++end;
    if (end == begin) ++end;
    const std::string word = text.substr(begin, end - begin);
    out += word == "left" ? "right" : word == "right" ? "left" : word;
    begin = end;
  }
  return out;
}

}  // namespace

Clip mirror(const Clip& clip) {
  Clip out = clip;
  for (int j = 0; j < kJoints; ++j) {
    const auto source =
        clip.poses.middleCols<3>(3 * mirrored_joints()[static_cast<std::size_t>(j)]);
    out.poses.col(3 * j) = source.col(0);
    out.poses.col(3 * j + 1) = -source.col(1);
    out.poses.col(3 * j + 2) = -source.col(2);
  }
  // The pelvis lies at trans + rest, and it is the pelvis that is mirrored.
  out.trans.col(0) = -clip.trans.col(0).array() - 2 * rest_joints(clip)(0, 0);
  for (auto& [name, value] : out.labels) value = swap_sides(value);
  return out;
}

}  // namespace mocaplm
