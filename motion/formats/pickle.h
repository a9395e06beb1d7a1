// A reader of the small part of Python's pickle format (protocols 2 to 5, PEP 3154 and PEP 574)
// that a dictionary of numpy arrays needs. A pickle is a program for a stack machine that may call
// any Python function; this reader knows numbers, text, bytes, tuples, lists, dictionaries and the
// handful of calls with which numpy rebuilds arrays, and refuses everything else by name. It never
// runs anything.
//
// Understood calls: numpy's _reconstruct, scalar and _frombuffer (numpy.core and numpy._core),
// ndarray, dtype, and _codecs.encode(text, "latin1"), with which Python 3 writes bytes in
// protocol 2.
#pragma once

#include <cstddef>
#include <deque>
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
  array
};

// One Python object. Texts and bytes are views into the file or into Pickle's own storage.
struct PickleValue {
  PickleKind kind = PickleKind::none;
  std::size_t byte = 0;             // where it was made
  double number = 0;                // boolean (0 or 1), integer, number
  std::string_view text;            // text (UTF-8), bytes, global ("module.name")
  std::vector<PickleValue*> items;  // tuple, list; dictionary: key, value, key, value, ...
  NumpyArray array;                 // type: array.type alone; array
  bool built = false;               // type, array: its state has been set
};

// "a list", "the function numpy.dtype": for messages.
std::string describe(const PickleValue& value);

// The objects of one pickle; `bytes` must outlive it.
class Pickle {
 public:
  // Throws DataError naming the byte: an opcode or global that is refused (by name), a truncated or
  // inconsistent file, more than 100,000 objects, 10,000 memo entries or 10,000 stack entries,
  // arrays of other things than numbers or text.
  Pickle(std::string_view bytes, const std::string& file);

  const PickleValue& root() const { return *root_; }
  // The value of a text key of the root, which must be a dictionary; nullptr when there is none.
  const PickleValue* find(const std::string& key) const;
  // The text keys of the root.
  std::vector<std::string> keys() const;

 private:
  friend class PickleMachine;
  std::deque<PickleValue> values_;   // never moves: others point here, also in circles
  std::deque<std::string> decoded_;  // bytes that were written as Latin-1 text
  PickleValue* root_ = nullptr;
};

}  // namespace mocaplm
