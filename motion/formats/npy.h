// numpy's .npy format, versions 1.0, 2.0 and 3.0 (numpy/lib/format.py; NEP 1):
//
//   0      93 'N' 'U' 'M' 'P' 'Y'
//   6      major, minor version
//   8      length of the header: 2 bytes (1.0) or 4 bytes (2.0, 3.0), little-endian
//   10|12  a Python dictionary in text, padded with spaces, ending in a newline:
//          {'descr': '<f8', 'fortran_order': False, 'shape': (60, 72), }
//   then   the elements
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motion/formats/numpy_array.h"

namespace mocaplm {

// The array inside `bytes`, as a view into them. `file` stands for the file in messages. Throws
// DataError naming the byte: wrong magic, unknown version, a header that is not such a dictionary,
// types that hold no plain numbers or text (parse_numpy_type), more or fewer bytes than the shape
// needs.
NumpyArray parse_npy(std::string_view bytes, const std::string& file);

// The same of a file's first bytes alone: type and shape are known, the data may be cut off.
NumpyArray parse_npy_header(std::string_view bytes, const std::string& file);

// The text of an array of one text or bytes element, as UTF-8 without its padding.
std::string single_text(const NumpyArray& array, const Place& place);

// Version 1.0 bytes of an array of doubles ("<f8", row-major); `values` has as many as the shape
// says.
std::string npy_bytes(const double* values, const std::vector<std::size_t>& shape);
// A single ASCII text ("<U7").
std::string npy_bytes(const std::string& text);

}  // namespace mocaplm
