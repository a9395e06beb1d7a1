// A place in a BVH text and the words there, with messages that name the line.
#pragma once

#include <string>
#include <string_view>

namespace mocaplm {

constexpr double kAbsurdBvhValue = 1e7;  // units or degrees

inline bool is_bvh_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

// Equal in any case.
bool same_word(std::string_view a, std::string_view b);
// What was found, for a message: short and printable.
std::string shown(std::string_view word);

struct BvhCursor {
  BvhCursor(std::string_view text, const std::string& name);

  [[noreturn]] void fail(const char* place, const std::string& message) const;
  // `found`, the last word, stands where `expected` should.
  [[noreturn]] void unexpected(std::string_view found, const std::string& expected) const;
  std::size_t line(const char* place) const;

  void skip_space() {
    while (at < end && is_bvh_space(*at)) ++at;
  }
  // The next word; empty at the end of the file. Braces are words of their own.
  std::string_view word();
  void expect(const char* keyword);
  // What is left of the line up to a brace, without blanks around it: a joint's name may have them
  // inside (3ds Max writes "Bip01 L Thigh").
  std::string_view rest_of_line();
  double number(const std::string& what);
  std::size_t count(const std::string& what, std::size_t max);
  // The same for the word in hand.
  double number_of(std::string_view found, const std::string& what) const;
  std::size_t count_of(std::string_view found, const std::string& what, std::size_t max) const;

  const char* begin;
  const char* at;
  const char* end;
  const char* last;  // where the last word began
  const std::string& file;
};

}  // namespace mocaplm
