// Named arrays of a file, whatever keeps them: a .npz archive, a pickled dictionary (.pkl of
// Python, joblib or pickled PyTorch tensors; .npy of np.save(dictionary)) or PyTorch's .pt archive.
// Dictionaries may lie in dictionaries (a person each, a part of the body each); a list is a
// dictionary with the keys "0", "1", ...; keys that are numbers are their text.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "motion/formats/numpy_array.h"

namespace mocaplm {

struct ArrayDictNode;

class ArrayDict {
 public:
  // The node holds the values; they live as long as any ArrayDict of the file.
  explicit ArrayDict(std::shared_ptr<const ArrayDictNode> node) : node_(std::move(node)) {}

  // Throws DataError naming file and byte: not one of these formats (naming what it looks like),
  // damaged, hostile, over 512 MiB, no dictionary.
  static ArrayDict open(const std::filesystem::path& path);

  // In the file's order; of an archive at most the first 1000.
  std::vector<std::string> keys() const;
  bool has(const std::string& key) const;
  // A key whose value is an array or a number (an array without dimensions). Arrays of .npz
  // archives are read when they are asked for. A list of arrays of one shape is one array with a
  // dimension more. Throws DataError for other values and for no such key.
  NumpyArray array(const std::string& key) const;
  // The dictionary or list of a key; none for other values.
  std::optional<ArrayDict> dict(const std::string& key) const;
  // A text, also as an array of one text.
  std::optional<std::string> text(const std::string& key) const;

  Place place(const std::string& key) const;
  const std::string& file() const;
  // "global_orient, body_pose, transl": the first 20 keys, for messages.
  std::string contents() const;

 private:
  std::shared_ptr<const ArrayDictNode> node_;
};

// Whether a .npy file holds a dictionary (Python objects) and not one array of numbers.
bool is_dict_npy(const std::filesystem::path& path);

}  // namespace mocaplm
