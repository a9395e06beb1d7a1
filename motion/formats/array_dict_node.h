// The two kinds of ArrayDict: a dictionary in a pickle, and a .npz archive.
#pragma once

#include <string>
#include <vector>

#include "motion/formats/array_dict.h"
#include "motion/formats/pickle.h"

namespace mocaplm {

struct ArrayDictNode {
  virtual ~ArrayDictNode() = default;
  virtual std::vector<std::string> keys() const = 0;
  virtual bool has(const std::string& key) const = 0;
  virtual NumpyArray array(const std::string& key) const = 0;
  virtual std::optional<ArrayDict> dict(const std::string& key) const = 0;
  virtual std::optional<std::string> text(const std::string& key) const = 0;
  virtual Place place(const std::string& key) const = 0;
  std::string file;
};

// `bytes` is a whole pickle. `entries` are a PyTorch archive's storages.
ArrayDict pickled_dict(std::string bytes, const std::string& file, LoadStorage load = nullptr);
// An archive of .npy entries, or of torch.save.
ArrayDict archived_dict(const std::filesystem::path& path);
// A .npy file or entry that holds Python objects: the pickle behind its header; "" when it holds
// numbers or text.
std::string_view pickle_of_npy(std::string_view bytes);
// What joblib.dump(..., compress=...) made smaller (zlib and gzip). Throws DataError when it is
// damaged or grows beyond what is read.
std::string inflate(std::string_view bytes, const std::string& file);

}  // namespace mocaplm
