#include "motion/formats/glb_file.h"

namespace mocaplm {

namespace {

void append_u32(std::string& bytes, std::size_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

}  // namespace

std::string glb_file(const Json& document, const std::string& numbers) {
  // A name may be any bytes; JSON is UTF-8.
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t padded = (numbers.size() + 3) / 4 * 4;
  const std::size_t total = 12 + 8 + text.size() + 8 + padded;
  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, total);
  append_u32(bytes, text.size());
  bytes += "JSON" + text;
  append_u32(bytes, padded);
  bytes.append("BIN\0", 4).append(numbers);
  bytes.resize(total, '\0');
  return bytes;
}

}  // namespace mocaplm
