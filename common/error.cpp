#include "common/error.h"

namespace mocaplm {

Place in_file(const std::string& file) {
  return {file, ""};
}

Place at_byte(const std::string& file, std::size_t byte) {
  return {file, "byte " + std::to_string(byte)};
}

Place at_line(const std::string& file, std::size_t line) {
  return {file, "line " + std::to_string(line)};
}

Place at_frame(const std::string& file, std::size_t frame) {
  return {file, "frame " + std::to_string(frame)};
}

Place at_joint(const std::string& file, std::size_t frame, const std::string& joint) {
  return {file, "frame " + std::to_string(frame) + ", joint " + joint};
}

std::string to_string(const Place& place) {
  return place.where.empty() ? place.file : place.file + ": " + place.where;
}

}  // namespace mocaplm
