// Small helpers for messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mocaplm {

std::string join(const std::vector<std::string>& parts, const std::string& between);
std::vector<std::string> split(const std::string& text, char at);
std::string lower(std::string text);

inline bool starts_with(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}
inline bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// The shortest form that reads well: 1e+300 stays, 0.5 stays, 3.0 becomes 3.
std::string format_number(double value);
// Fixed digits after the point.
std::string format_fixed(double value, int digits);
// The same behind a text, faster and whatever the locale: for files of many numbers. At most 60
// digits.
void append_fixed(std::string& text, double value, int digits);
// "1:02:03", "4:05", "12 s".
std::string format_duration(double seconds);

// ", did you mean \"waack\"?" for the nearest candidate in edit distance, or "" when none is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);
// The end of a message about an unknown name: the nearest one if any, then `intro` and all of them.
std::string known_names(const std::string& word, const std::vector<std::string>& candidates,
                        const std::string& intro = "Known");

}  // namespace mocaplm
