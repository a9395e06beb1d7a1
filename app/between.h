// A piece of a text.
#pragma once

#include <string>

namespace mocaplm {

// What lies between the first `begin` and the next `end`, "" where one is missing.
inline std::string between(const std::string& text, const std::string& begin,
                           const std::string& end) {
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return "";
  const std::size_t first = at + begin.size(), last = text.find(end, first);
  return last == std::string::npos ? "" : text.substr(first, last - first);
}

}  // namespace mocaplm
