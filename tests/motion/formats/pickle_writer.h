// Writes pickles of numpy arrays as Python does, for the tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace mocaplm {

struct PickleStyle {
  int protocol = 4;
  std::string module = "numpy.core";  // "numpy._core" since numpy 2
  bool big_endian = false;
  bool fortran = false;
  int item_bytes = 8;  // 8 or 4
};

class PickleWriter {
 public:
  explicit PickleWriter(const PickleStyle& style) : style_(style) {
    out_ = "\x80";
    out_ += static_cast<char>(style.protocol);
  }

  void op(const std::string& opcode, std::uint64_t value = 0, int bytes = 1) {
    out_ += opcode;
    for (int i = 0; i < bytes; ++i) out_ += static_cast<char>(value >> (8 * i) & 0xff);
  }
  void raw(const std::string& bytes) { out_ += bytes; }
  void begin_dictionary() { out_ += "}("; }
  void end_dictionary() { out_ += "u"; }
  void text(const std::string& text) {
    if (style_.protocol >= 4)
      op("\x8c", text.size());
    else
      op("X", text.size(), 4);
    out_ += text;
  }
  void global(const std::string& module, const std::string& name) {
    if (style_.protocol < 4) {
      out_ += "c" + module + "\n" + name + "\n";
      return;
    }
    text(module);
    text(name);
    out_ += "\x93";
  }
  void bytes(const std::string& bytes) {
    if (style_.protocol >= 5) {
      op("\x96", bytes.size(), 8);
      out_ += bytes;
    } else if (style_.protocol >= 3) {
      op("B", bytes.size(), 4);
      out_ += bytes;
    } else {
      global("_codecs", "encode");
      std::string utf8;
      for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x80) utf8 += static_cast<char>(0xc0 | byte >> 6);
        utf8 += static_cast<char>(byte >= 0x80 ? 0x80 | (byte & 0x3f) : byte);
      }
      text(utf8);
      text("latin1");
      out_ += "\x86R";
    }
  }
  void dtype() {
    global("numpy", "dtype");
    text(style_.item_bytes == 8 ? "f8" : "f4");
    out_ += "\x89\x88\x87R(K\x03";
    text(style_.big_endian ? ">" : "<");
    out_ += std::string("NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\0tb", 17);
  }
  // Row-major values; stored as the style says.
  void array(const std::vector<double>& values, std::size_t rows, std::size_t columns) {
    std::string data;
    for (std::size_t i = 0; i < values.size(); ++i)
      data += element(values[style_.fortran ? i % rows * columns + i / rows : i]);
    if (style_.protocol >= 5) {
      global(style_.module + ".numeric", "_frombuffer");
      out_ += "(";
      bytes(data);
      dtype();
      shape(rows, columns);
      text(style_.fortran ? "F" : "C");
      out_ += "tR";
      return;
    }
    global(style_.module + ".multiarray", "_reconstruct");
    global("numpy", "ndarray");
    out_ += std::string("K\0\x85", 3);
    bytes("b");
    out_ += "\x87R(K\x01";
    shape(rows, columns);
    dtype();
    out_ += style_.fortran ? "\x88" : "\x89";
    bytes(data);
    out_ += "tb";
  }
  std::string finish() const { return out_ + "."; }

 private:
  void shape(std::size_t rows, std::size_t columns) {
    op("M", rows, 2);
    if (columns > 0) op("M", columns, 2);
    out_ += columns > 0 ? "\x86" : "\x85";
  }
  std::string element(double value) const {
    const auto narrow = static_cast<float>(value);
    const char* at = style_.item_bytes == 8 ? reinterpret_cast<const char*>(&value)
                                            : reinterpret_cast<const char*>(&narrow);
    const std::string one(at, static_cast<std::size_t>(style_.item_bytes));
    return style_.big_endian ? std::string(one.rbegin(), one.rend()) : one;
  }

  PickleStyle style_;
  std::string out_;
};

}  // namespace mocaplm
