#include "motion/formats/bvh_number.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace mocaplm {

namespace {

// Powers of ten that a double holds exactly.
constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

constexpr std::uint64_t kWholePowers[] = {1,      10,      100,      1000,     10000,
                                          100000, 1000000, 10000000, 100000000};

// Bytes are compared eight at a time in one word; the first byte of the text is the lowest.
constexpr std::uint64_t kOnes = 0x0101010101010101;

std::uint64_t load(const char* at) {
  std::uint64_t bytes;
  std::memcpy(&bytes, at, sizeof bytes);
  return bytes;  // little-endian, as every processor that Debian's LibTorch runs on
}

// The number of leading bytes of the word that are digits, 0 to 8.
int leading_digits(std::uint64_t bytes) {
  // Adding 0x46 lifts bytes above '9' to 0x80 and more, subtracting '0' those below it.
  const std::uint64_t low = bytes & (0x7F * kOnes);
  const std::uint64_t above = low + 0x46 * kOnes;                     // bit 7: > '9'
  const std::uint64_t below = (low | (0x80 * kOnes)) - 0x30 * kOnes;  // bit 7 clear: < '0'
  const std::uint64_t other = (bytes | above | ~below) & (0x80 * kOnes);
  return other == 0 ? 8 : __builtin_ctzll(other) / 8;
}

// The value of the first `count` bytes, all digits, 1 to 8: two, four, then eight digits at a time
// in one multiplication each.
std::uint64_t digits_value(std::uint64_t bytes, int count) {
  bytes <<= 64 - 8 * count;  // leading zeros: bytes below are 0, as "0" - '0' will be
  bytes &= 0x0F * kOnes;
  bytes = bytes * 10 + (bytes >> 8);
  constexpr std::uint64_t kMask = 0x000000FF000000FF;
  return ((bytes & kMask) * 0x000F424000000064 + ((bytes >> 16) & kMask) * 0x0000271000000001) >>
         32;
}

// The number by the library: any length, any exponent.
const char* parse_slowly(const char* from, const char* to, double& value) {
  const char* start = from < to && *from == '+' ? from + 1 : from;
  if (start > from && start < to && *start == '-') return from;
  const auto result = std::from_chars(start, to, value);
  if (result.ec == std::errc()) return result.ptr;
  if (result.ec != std::errc::result_out_of_range) return from;
  const std::string_view digits(start, static_cast<std::size_t>(result.ptr - start));
  value = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos ? 0 : HUGE_VAL;
  return result.ptr;
}

// The decimal exponent at "e-07", or 0 where none stands; moves `at` past it. One or two digits.
int exponent(const char*& at) {
  if ((*at | 0x20) != 'e') return 0;
  const bool negative = at[1] == '-';
  const char* digit = at + 1 + (negative || at[1] == '+');
  int value = 0;
  const char* first = digit;
  for (; digit < first + 2 && *digit >= '0' && *digit <= '9'; ++digit)
    value = 10 * value + (*digit - '0');
  if (digit == first) return 0;  // `at` stays, so the caller sees that this is no plain number
  at = digit;
  return negative ? -value : value;
}

}  // namespace

// Up to seven digits before the point and up to eight behind it are at most 15 digits: a whole
// number that a double holds exactly, as it does powers of ten up to 22. Their product or quotient
// is then rounded once, which makes it the nearest double (Clinger, "How to read floating point
// numbers accurately", 1990).
const char* parse_number(const char* from, const char* to, double& value) {
  if (to - from < 24) return parse_slowly(from, to, value);  // words may be loaded below
  const bool negative = *from == '-';
  const char* at = from + negative;
  const std::uint64_t head = load(at);
  const int whole = leading_digits(head);
  if (whole == 0 || whole == 8) return parse_slowly(from, to, value);
  std::uint64_t mantissa = digits_value(head, whole);
  at += whole;
  int power = 0;
  if (*at == '.') {
    const std::uint64_t tail = load(++at);
    const int digits = leading_digits(tail);
    if (digits == 0) return parse_slowly(from, to, value);
    mantissa = mantissa * kWholePowers[digits] + digits_value(tail, digits);
    at += digits;
    power = digits;
  }
  if (static_cast<unsigned char>(*at) > ' ') {  // more digits, an exponent, or no number
    power -= exponent(at);
    if (static_cast<unsigned char>(*at) > ' ' || power > 22 || power < 0)
      return parse_slowly(from, to, value);
  }
  const double magnitude = static_cast<double>(mantissa) / kPowers[power];
  value = negative ? -magnitude : magnitude;
  return at;
}

}  // namespace mocaplm
