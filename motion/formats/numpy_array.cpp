#include "motion/formats/numpy_array.h"

#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/text.h"

namespace mocaplm {

namespace {

std::uint64_t read_bits(const char* bytes, std::size_t count, bool big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto byte = static_cast<unsigned char>(bytes[big_endian ? i : count - 1 - i]);
    bits = bits << 8 | byte;
  }
  return bits;
}

// IEEE 754 binary16.
double half_value(std::uint64_t bits) {
  const int exponent = static_cast<int>(bits >> 10 & 31);
  const auto fraction = static_cast<double>(bits & 1023);
  const double sign = bits >> 15 ? -1 : 1;
  if (exponent == 31) return fraction == 0 ? sign * HUGE_VAL : std::nan("");
  return sign *
         (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25));
}

double float_value(std::uint64_t bits, std::size_t bytes) {
  if (bytes == 2) return half_value(bits);
  if (bytes == 4) {
    const auto narrow = static_cast<std::uint32_t>(bits);
    float value;
    std::memcpy(&value, &narrow, 4);
    return static_cast<double>(value);
  }
  double value;
  std::memcpy(&value, &bits, 8);
  return value;
}

double signed_value(std::uint64_t bits, std::size_t bytes) {
  const std::size_t unused = 64 - 8 * bytes;
  return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
}

bool known_size(char kind, std::size_t size) {
  switch (kind) {
    case 'f':
      return size == 2 || size == 4 || size == 8;
    case 'i':
    case 'u':
      return size == 1 || size == 2 || size == 4 || size == 8;
    case 'b':
      return size == 1;
    case 'U':
    case 'S':
      return size <= 1 << 20;
    default:
      return false;
  }
}

std::string why_not(char kind) {
  switch (kind) {
    case 'O':
      return " (Python objects, which are never loaded)";
    case 'V':
      return " (structures)";
    case 'c':
      return " (complex numbers)";
    default:
      return "";
  }
}

}  // namespace

NumpyType parse_numpy_type(std::string_view text, const Place& place) {
  NumpyType type;
  std::string_view rest = text;
  if (!rest.empty() && std::strchr("<>|=", rest[0]) != nullptr) {
    type.big_endian = rest[0] == '>';
    rest.remove_prefix(1);
  }
  if (rest == "?") rest = "b1";
  std::size_t size = 0;
  bool good = !rest.empty() && rest.size() <= 8;
  for (std::size_t i = 1; good && i < rest.size(); ++i) {
    good = rest[i] >= '0' && rest[i] <= '9';
    size = 10 * size + static_cast<std::size_t>(rest[i] - '0');
  }
  type.kind = rest.empty() ? '?' : rest[0];
  if (type.kind == 'a') type.kind = 'S';
  if (!good || !known_size(type.kind, size))
    throw DataError(place, "holds elements of type \"" + std::string(text.substr(0, 40)) + "\"" +
                               why_not(type.kind) +
                               ", expected numbers such as <f8 or <f4, or text");
  type.item_bytes = type.kind == 'U' ? 4 * size : size;
  return type;
}

bool NumpyArray::is_plain() const {
  const std::uint16_t one = 1;
  const bool little_endian = *reinterpret_cast<const unsigned char*>(&one) == 1;
  return type.kind == 'f' && type.item_bytes == sizeof(double) && !column_major &&
         type.big_endian != little_endian;
}

double NumpyArray::at(std::size_t row, std::size_t column) const {
  assert(type.is_number() && row < rows() && column < columns());
  const std::size_t index = column_major ? column * rows() + row : row * columns() + column;
  const std::size_t bytes = type.item_bytes;
  const std::uint64_t bits = read_bits(data.data() + index * bytes, bytes, type.big_endian);
  switch (type.kind) {
    case 'f':
      return float_value(bits, bytes);
    case 'i':
      return signed_value(bits, bytes);
    default:
      return static_cast<double>(bits);
  }
}

std::string shape_text(const NumpyArray& array) {
  std::vector<std::string> parts;
  for (const std::size_t n : array.shape) parts.push_back(std::to_string(n));
  return "(" + join(parts, ", ") + (parts.size() == 1 ? ",)" : ")");
}

void check_array_size(const NumpyArray& array, const Place& place) {
  std::size_t bytes = array.type.item_bytes;
  bool fits = true;
  for (const std::size_t n : array.shape) fits = !__builtin_mul_overflow(bytes, n, &bytes) && fits;
  if (!fits || bytes != array.data.size())
    throw DataError(place, "the shape " + shape_text(array) + " needs " +
                               (fits ? std::to_string(bytes) : std::string("more than 2^64")) +
                               " bytes of data, but " + std::to_string(array.data.size()) +
                               " are there: the file is truncated or damaged");
}

void check_motion_array(const NumpyArray& array, const std::string& name, std::size_t columns,
                        const Place& place) {
  const std::string wanted =
      "(frames, " + (columns == 0 ? std::string("columns") : std::to_string(columns)) + ")";
  if (array.type.kind != 'f')
    throw DataError(place, name + " holds elements of kind '" + std::string(1, array.type.kind) +
                               "', expected floating-point numbers");
  if (array.dimensions() != 2 || (columns != 0 && array.columns() != columns))
    throw DataError(place, name + " has the shape " + shape_text(array) + ", expected " + wanted);
  if (array.rows() == 0) throw DataError(place, name + " has no frames");
  if (array.rows() > kMaxClipFrames)
    throw DataError(place, name + " has " + std::to_string(array.rows()) +
                               " frames, more than the limit of " + std::to_string(kMaxClipFrames) +
                               "; cut it into several clips");
}

double single_number(const NumpyArray& array, const std::string& name, const Place& place) {
  std::size_t count = 1;
  for (const std::size_t n : array.shape) count = n == 1 ? count : 0;
  if (count != 1 || !array.type.is_number())
    throw DataError(place, name + " has the shape " + shape_text(array) +
                               " and elements of kind '" + std::string(1, array.type.kind) +
                               "', expected a single number");
  return array.at(0, 0);
}

}  // namespace mocaplm
