#include "motion/formats/npy.h"

#include <cstdint>
#include <cstring>
#include <optional>

namespace mocaplm {

namespace {

constexpr std::string_view kNpyMagic("\x93NUMPY", 6);
constexpr std::size_t kMaxHeader = 1 << 16;
constexpr std::size_t kMaxDimensions = 32;  // numpy's own limit

// Reads the header's dictionary literal.
class HeaderParser {
 public:
  HeaderParser(std::string_view text, std::size_t offset, const std::string& file)
      : text_(text), offset_(offset), file_(file) {}

  NumpyArray parse() {
    expect('{');
    while (!accept('}')) {
      const std::size_t begin = at_;
      const std::string_view key = quoted();
      expect(':');
      if (key == "descr")
        descr();
      else if (key == "fortran_order")
        array_.column_major = boolean();
      else if (key == "shape")
        shape();
      else
        fail(begin, "unknown key \"" + std::string(key.substr(0, 40)) + "\"");
      seen_ += std::string(key) + " ";
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    for (const char* key : {"descr", "fortran_order", "shape"})
      if (seen_.find(key) == std::string::npos) fail(at_, std::string("has no '") + key + "'");
    space();
    if (at_ != text_.size()) fail(at_, "has something behind the closing brace");
    return array_;
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw DataError(at_byte(file_, offset_ + at),
                    "the .npy header " + what +
                        "; expected {'descr': '<f8', 'fortran_order': "
                        "False, 'shape': (60, 72), }");
  }
  void space() {
    while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) != nullptr && text_[at_] != 0)
      ++at_;
  }
  bool accept(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(at_, std::string("lacks a '") + c + "'");
  }
  std::string_view quoted() {
    space();
    const char quote = at_ < text_.size() ? text_[at_] : 0;
    if (quote != '\'' && quote != '"') fail(at_, "lacks a quoted word");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail(at_, "has a quote that does not end");
    const std::string_view word = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return word;
  }
  void descr() {
    space();
    if (at_ < text_.size() && text_[at_] == '[') fail(at_, "describes structures, not numbers");
    const std::size_t begin = at_;
    array_.type = parse_numpy_type(quoted(), at_byte(file_, offset_ + begin));
  }
  bool boolean() {
    space();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (text_.substr(at_, word.size()) != word) continue;
      at_ += word.size();
      return value;
    }
    fail(at_, "has neither True nor False for 'fortran_order'");
  }
  void shape() {
    expect('(');
    array_.shape.clear();
    while (!accept(')')) {
      array_.shape.push_back(whole_number());
      if (array_.shape.size() > kMaxDimensions) fail(at_, "has more than 32 dimensions");
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
  }
  std::size_t whole_number() {
    space();
    const std::size_t begin = at_;
    std::size_t value = 0;
    while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') {
      if (at_ - begin >= 18) fail(begin, "has an absurd number in 'shape'");
      value = 10 * value + static_cast<std::size_t>(text_[at_++] - '0');
    }
    if (at_ == begin) fail(at_, "lacks a whole number in 'shape'");
    if (at_ < text_.size() && text_[at_] == 'L') ++at_;  // Python 2 wrote 60L
    return value;
  }

  std::string_view text_;
  std::size_t offset_, at_ = 0;
  const std::string& file_;
  NumpyArray array_;
  std::string seen_;
};

void append_utf8(std::string& out, std::uint32_t code) {
  if (code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) code = 0xfffd;
  if (code < 0x80) {
    out += static_cast<char>(code);
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  const unsigned lead[] = {0, 0xc0, 0xe0, 0xf0};
  out += static_cast<char>(lead[more] | code >> (6 * more));
  for (int i = more - 1; i >= 0; --i) out += static_cast<char>(0x80 | (code >> (6 * i) & 0x3f));
}

std::string with_header(const std::string& descr, const std::string& shape) {
  std::string header =
      "{'descr': '" + descr + "', 'fortran_order': False, 'shape': " + shape + ", }";
  const std::size_t preamble = kNpyMagic.size() + 4;
  // The data begins at a multiple of 64.
  header.append(63 - (preamble + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes(kNpyMagic);
  bytes += {1, 0, static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  return bytes + header;
}

}  // namespace

NumpyArray parse_npy(std::string_view bytes, const std::string& file) {
  NumpyArray array = parse_npy_header(bytes, file);
  check_array_size(array, at_byte(file, bytes.size() - array.data.size()));
  return array;
}

NumpyArray parse_npy_header(std::string_view bytes, const std::string& file) {
  if (bytes.substr(0, 6) != kNpyMagic)
    throw DataError(at_byte(file, 0), "is not a .npy array: it does not begin with \\x93NUMPY");
  if (bytes.size() < 10)
    throw DataError(at_byte(file, bytes.size()), "ends inside the .npy header");
  const int major = static_cast<unsigned char>(bytes[6]);
  if (major < 1 || major > 3)
    throw DataError(at_byte(file, 6),
                    "has .npy version " + std::to_string(major) + ", expected 1, 2 or 3");
  const std::size_t start = major == 1 ? 10 : 12;
  if (bytes.size() < start)
    throw DataError(at_byte(file, bytes.size()), "ends inside the .npy header");
  std::size_t length = 0;
  for (std::size_t i = start; i > 8; --i)
    length = length << 8 | static_cast<unsigned char>(bytes[i - 1]);
  if (length > kMaxHeader || length > bytes.size() - start)
    throw DataError(at_byte(file, 8), "says that its .npy header has " + std::to_string(length) +
                                          " bytes, more than are there or than 65536");
  NumpyArray array = HeaderParser(bytes.substr(start, length), start, file).parse();
  array.data = bytes.substr(start + length);
  return array;
}

std::string single_text(const NumpyArray& array, const Place& place) {
  const std::size_t unit = array.type.kind == 'U' ? 4 : 1;
  if (array.type.is_number() || array.data.size() != array.type.item_bytes)
    throw DataError(place, "has the shape " + shape_text(array) + ", expected a single text");
  std::string text;
  for (std::size_t i = 0; i < array.data.size(); i += unit) {
    std::uint32_t code = 0;
    for (std::size_t b = 0; b < unit; ++b) {
      const auto byte = static_cast<unsigned char>(array.data[i + b]);
      code |= static_cast<std::uint32_t>(byte) << 8 * (array.type.big_endian ? unit - 1 - b : b);
    }
    append_utf8(text, code);
  }
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::string npy_bytes(const double* values, const std::vector<std::size_t>& shape) {
  NumpyArray array;
  array.shape = shape;
  std::size_t count = 1;
  for (const std::size_t n : shape) count *= n;
  std::string bytes = with_header("<f8", shape_text(array));
  const std::size_t header = bytes.size();
  bytes.resize(header + 8 * count);
  char* out = bytes.data() + header;
  for (std::size_t i = 0; i < count; ++i, out += 8) {
    std::uint64_t bits;
    std::memcpy(&bits, values + i, 8);
    for (int b = 0; b < 8; ++b) out[b] = static_cast<char>(bits >> (8 * b) & 0xff);
  }
  return bytes;
}

std::string npy_bytes(const std::string& text) {
  std::string bytes = with_header("<U" + std::to_string(text.size()), "()");
  for (const char c : text) bytes.append({c, 0, 0, 0});
  return bytes;
}

}  // namespace mocaplm
