// The safetensors file format: 8 bytes little-endian length N, N bytes of JSON header
// {"name": {"dtype": "F32", "shape": [..], "data_offsets": [begin, end]}}, then the raw values.
// https://github.com/huggingface/safetensors (format section). Only F32 is used here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace mocaplm {

// Larger files are no models of this program.
inline constexpr std::uintmax_t kMaxModelBytes = std::uintmax_t{16} << 30;

struct NamedTensor {
  std::vector<std::int64_t> shape;
  std::vector<float> values;  // row-major

  std::int64_t size() const;
};

using TensorMap = std::map<std::string, NamedTensor>;

void write_safetensors(const std::filesystem::path& path, const TensorMap& tensors);
// Throws DataError naming the byte for truncated or inconsistent files (offsets outside the file,
// overlapping or leftover bytes, sizes that do not match the shape, other dtypes, non-finite
// values).
TensorMap read_safetensors(const std::filesystem::path& path);

}  // namespace mocaplm
