// A reader of the small part of Python's pickle format (protocols 2 to 5, PEP 3154 and PEP 574)
// that a dictionary of numpy arrays needs. A pickle is a program for a stack machine that may call
// any Python function; this reader knows numbers, text, bytes, tuples, lists, dictionaries and the
// handful of calls with which arrays are rebuilt, and refuses everything else by name. It never
// runs anything.
//
// Understood calls: numpy's _reconstruct, scalar and _frombuffer (numpy.core and numpy._core),
// ndarray, dtype, and _codecs.encode(text, "latin1"), with which Python 3 writes bytes in
// protocol 2; collections' dictionaries; PyTorch's tensors on their way through pickle
// (pickle_torch.cpp). Objects of a few classes that hold arrays become their named values: chumpy's
// and scipy's (of SMPL's model files), and joblib's, behind whose wrapper the array's bytes lie in
// the file (joblib/numpy_pickle.py).
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/formats/numpy_array.h"

namespace mocaplm {

enum class PickleKind {
  none,
  boolean,
  integer,
  number,
  text,
  bytes,
  tuple,
  list,
  dictionary,
  global,
  type,
  array,
  object,  // of a class in `text`; items as a dictionary's
  storage  // a PyTorch tensor's memory: array.type, array.data
};

// One Python object. Texts and bytes are views into the file or into Pickle's own storage.
struct PickleValue {
  PickleKind kind = PickleKind::none;
  std::size_t byte = 0;   // where it was made
  double number = 0;      // boolean (0 or 1), integer, number
  std::string_view text;  // text (UTF-8), bytes, global ("module.name")
  // tuple, list (also numpy's arrays of objects); dictionary, object: key, value, key, value, ...
  std::vector<PickleValue*> items;
  NumpyArray array;    // type: array.type alone; array
  bool built = false;  // type, array: its state has been set
};

// "a list", "the function numpy.dtype": for messages.
std::string describe(const PickleValue& value);

// The value of a text key of a dictionary or object, nullptr when there is none.
const PickleValue* find_value(const PickleValue& dictionary, std::string_view key);

// The bytes of a PyTorch archive's storage by its key. They must live as long as the pickle.
using LoadStorage = std::function<std::string_view(const std::string& key)>;

// The objects of one pickle; `bytes` must outlive it.
class Pickle {
 public:
  // Throws DataError naming the byte: an opcode or global that is refused (by name), a truncated or
  // inconsistent file, more than a million objects or memo entries, or 10,000 stack entries,
  // arrays of other things than numbers or text.
  Pickle(std::string_view bytes, const std::string& file, LoadStorage load = nullptr);

  const PickleValue& root() const { return *root_; }
  // The value of a text key of the root, which must be a dictionary; nullptr when there is none.
  const PickleValue* find(const std::string& key) const;
  // The text keys of the root.
  std::vector<std::string> keys() const;

 private:
  friend class PickleMachine;
  std::deque<PickleValue> values_;   // never moves: others point here, also in circles
  std::deque<std::string> decoded_;  // bytes that were written as Latin-1 text
  LoadStorage load_;
  PickleValue* root_ = nullptr;
};

}  // namespace mocaplm
