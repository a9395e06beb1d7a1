#include "model/safetensors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"

namespace mocaplm {

namespace {

constexpr std::uint64_t kMaxHeader = 16u << 20;

std::uint64_t read_length(const std::string& bytes, const std::string& file) {
  if (bytes.size() < 8)
    throw DataError(in_file(file), "has " + std::to_string(bytes.size()) +
                                       " bytes, too few for a safetensors file");
  std::uint64_t length = 0;
  for (int i = 7; i >= 0; --i)
    length = length << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  if (length > kMaxHeader || length > bytes.size() - 8)
    throw DataError(at_byte(file, 0), "header length " + std::to_string(length) +
                                          " exceeds the file: not a safetensors file, or cut off");
  return length;
}

NamedTensor read_tensor(const Json& entry, const std::string& name, const std::string& data,
                        std::uint64_t base, std::uint64_t& expected_begin,
                        const std::string& file) {
  JsonObject object(entry, file + ": tensor " + name);
  object.choice("dtype", {"F32"});
  NamedTensor tensor;
  std::uint64_t count = 1;
  const std::uint64_t available = data.size() - base;
  const Json& shape = object.raw("shape");
  if (!shape.is_array()) object.fail("shape", "expected a list, found " + shape.dump());
  for (const Json& extent : shape) {
    if (!extent.is_number_unsigned() || extent.get<std::uint64_t>() > available)
      object.fail("shape", "expected whole numbers within the file's size, found " + extent.dump());
    const auto rows = extent.get<std::uint64_t>();
    if (rows > 0 && count > available / rows)
      object.fail("shape", "needs more bytes than the file has: the file is cut off or damaged");
    tensor.shape.push_back(static_cast<std::int64_t>(rows));
    count *= rows;
  }
  const Json& offsets = object.raw("data_offsets");
  if (!offsets.is_array() || offsets.size() != 2 || !offsets[0].is_number_unsigned() ||
      !offsets[1].is_number_unsigned())
    object.fail("data_offsets", "expected two byte offsets, found " + offsets.dump());
  object.finish();
  const auto begin = offsets[0].get<std::uint64_t>(), end = offsets[1].get<std::uint64_t>();
  if (begin != expected_begin || end < begin || end - begin != 4 * count)
    object.fail("data_offsets", "found " + offsets.dump() + ", expected " +
                                    std::to_string(4 * count) + " bytes from " +
                                    std::to_string(expected_begin));
  if (end > available)
    throw DataError(at_byte(file, data.size()), "ends inside tensor " + name + ", which needs " +
                                                    std::to_string(end - available) +
                                                    " bytes more: the file is cut off");
  tensor.values.resize(count);
  if (count > 0) std::memcpy(tensor.values.data(), data.data() + base + begin, 4 * count);
  for (std::uint64_t i = 0; i < count; ++i)
    if (!std::isfinite(tensor.values[i]))
      throw DataError(at_byte(file, base + begin + 4 * i),
                      "tensor " + name + " holds a value that is not finite");
  expected_begin = end;
  return tensor;
}

}  // namespace

std::int64_t NamedTensor::size() const {
  std::int64_t count = 1;
  for (const std::int64_t extent : shape) count *= extent;
  return count;
}

void write_safetensors(const std::filesystem::path& path, const TensorMap& tensors) {
  Json header = Json::object();
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : tensors) {
    const std::uint64_t bytes = 4 * tensor.values.size();
    header[name] = {
        {"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {offset, offset + bytes}}};
    offset += bytes;
  }
  std::string text = header.dump();
  text.append((8 - text.size() % 8) % 8, ' ');  // values start at a multiple of 8 bytes
  write_file_with(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    for (int i = 0; i < 8; ++i) out.put(static_cast<char>(text.size() >> (8 * i) & 0xFF));
    out << text;
    for (const auto& [name, tensor] : tensors)
      out.write(reinterpret_cast<const char*>(tensor.values.data()),
                static_cast<std::streamsize>(4 * tensor.values.size()));
    out.flush();
    if (!out) throw DataError(in_file(path.string()), "cannot be written: is the disk full?");
  });
}

TensorMap read_safetensors(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string bytes = read_file(path, kMaxModelBytes);
  const std::uint64_t length = read_length(bytes, file);
  const Json header = parse_json(bytes.substr(8, length), file + ": header");
  if (!header.is_object()) throw DataError(at_byte(file, 8), "expected a JSON object as header");
  TensorMap tensors;
  std::uint64_t begin = 0;
  // In the order of the data, so that a gap or an overlap shows.
  std::vector<std::pair<std::uint64_t, std::string>> order;
  for (const auto& item : header.items()) {
    if (item.key() == "__metadata__") continue;
    std::uint64_t at = 0;
    if (item.value().is_object() && item.value().contains("data_offsets")) {
      const Json& offsets = item.value()["data_offsets"];
      if (offsets.is_array() && !offsets.empty() && offsets[0].is_number_unsigned())
        at = offsets[0].get<std::uint64_t>();
    }
    order.emplace_back(at, item.key());
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [at, name] : order)
    tensors[name] = read_tensor(header[name], name, bytes, 8 + length, begin, file);
  if (8 + length + begin != bytes.size())
    throw DataError(at_byte(file, 8 + length + begin),
                    "has " + std::to_string(bytes.size() - 8 - length - begin) +
                        " bytes after the last tensor");
  return tensors;
}

}  // namespace mocaplm
