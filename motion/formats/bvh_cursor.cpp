#include "motion/formats/bvh_cursor.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "common/error.h"
#include "motion/formats/bvh_number.h"

namespace mocaplm {

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) ==
                  std::tolower(static_cast<unsigned char>(y));
         });
}

std::string shown(std::string_view word) {
  std::string text = "\"";
  for (const char c : word.substr(0, 40)) text += c >= 32 && c < 127 ? c : '?';
  return text + (word.size() > 40 ? "...\"" : "\"");
}

BvhCursor::BvhCursor(std::string_view text, const std::string& name)
    : begin(text.data()), at(begin), end(begin + text.size()), last(begin), file(name) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") at += 3;
  // DOS ends texts with Ctrl-Z; zeros are what a disk leaves behind a file that was cut.
  while (end > at && (end[-1] == '\x1A' || end[-1] == '\0')) --end;
}

void BvhCursor::fail(const char* place, const std::string& message) const {
  throw DataError(at_line(file, line(place)), message);
}

void BvhCursor::unexpected(std::string_view found, const std::string& expected) const {
  fail(last, (found.empty() ? "the file ends" : "found " + shown(found)) + " where " + expected +
                 " is expected");
}

std::size_t BvhCursor::line(const char* place) const {
  return 1 + static_cast<std::size_t>(std::count(begin, place, '\n'));
}

std::string_view BvhCursor::word() {
  skip_space();
  last = at;
  if (at < end && (*at == '{' || *at == '}')) return {at++, 1};
  while (at < end && !is_bvh_space(*at) && *at != '{' && *at != '}') ++at;
  return {last, static_cast<std::size_t>(at - last)};
}

void BvhCursor::expect(const char* keyword) {
  const std::string_view found = word();
  if (!same_word(found, keyword)) unexpected(found, keyword);
}

std::string_view BvhCursor::rest_of_line() {
  while (at < end && (*at == ' ' || *at == '\t')) ++at;
  last = at;
  while (at < end && *at != '\n' && *at != '\r' && *at != '{' && *at != '}') ++at;
  std::string_view rest(last, static_cast<std::size_t>(at - last));
  while (!rest.empty() && is_bvh_space(rest.back())) rest.remove_suffix(1);
  return rest;
}

double BvhCursor::number(const std::string& what) {
  return number_of(word(), what);
}

std::size_t BvhCursor::count(const std::string& what, std::size_t max) {
  return count_of(word(), what, max);
}

double BvhCursor::number_of(std::string_view found, const std::string& what) const {
  double value = 0;
  const char* stop = parse_number(found.data(), found.data() + found.size(), value);
  if (!found.empty() && found.find(',') != found.npos && found.find('.') == found.npos)
    fail(last, "found " + shown(found) + ", a number with a decimal comma, where " + what +
                   " is expected: write points in place of all commas");
  if (found.empty() || stop != found.data() + found.size() || !(std::abs(value) <= kAbsurdBvhValue))
    unexpected(found, what + " (a finite number)");
  return value;
}

std::size_t BvhCursor::count_of(std::string_view found, const std::string& what,
                                std::size_t max) const {
  std::size_t value = 0;
  const auto result = std::from_chars(found.data(), found.data() + found.size(), value);
  if (found.empty() || result.ec != std::errc() || result.ptr != found.data() + found.size() ||
      value > max)
    unexpected(found, what + " (a whole number of at most " + std::to_string(max) + ")");
  return value;
}

}  // namespace mocaplm
