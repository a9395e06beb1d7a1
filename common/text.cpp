#include "common/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "common/suggest.h"

namespace mocaplm {

std::string join(const std::vector<std::string>& parts, const std::string& between) {
  std::string all;
  for (std::size_t i = 0; i < parts.size(); ++i) all += (i ? between : "") + parts[i];
  return all;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string format_number(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string format_fixed(double value, int digits) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
  return buffer;
}

void append_fixed(std::string& text, double value, int digits) {
  char buffer[400];  // the largest double has 309 digits before the point
  const std::to_chars_result result =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, digits);
  text.append(buffer, result.ptr);
}

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0 || seconds > 1e8) return "?";
  const long whole = std::lround(seconds);
  char buffer[64];
  if (whole < 60)
    std::snprintf(buffer, sizeof buffer, "%ld s", whole);
  else if (whole < 3600)
    std::snprintf(buffer, sizeof buffer, "%ld:%02ld", whole / 60, whole % 60);
  else
    std::snprintf(buffer, sizeof buffer, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60,
                  whole % 60);
  return buffer;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(word, candidates);
  return nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?";
}

std::string known_names(const std::string& word, const std::vector<std::string>& candidates,
                        const std::string& intro) {
  constexpr std::size_t kMost = 40;
  const std::string near = did_you_mean(word, candidates);
  std::vector<std::string> shown = candidates;
  if (shown.size() > kMost) {
    shown.resize(kMost);
    shown.push_back("...");
  }
  return (near.empty() ? "." : near) + " " + intro + ": " + join(shown, ", ");
}

}  // namespace mocaplm
