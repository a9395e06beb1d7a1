// Arrays as numpy stores them, in .npy entries and in pickles: a type, a shape, raw bytes.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.h"

namespace mocaplm {

// The longest clip that is read from a file: 576 MB of poses.
constexpr std::size_t kMaxClipFrames = 1000000;

// numpy's array-protocol type string "<f8": byte order, kind, bytes of one element.
struct NumpyType {
  char kind = 'f';  // f float, i signed, u unsigned, b bool, U text (UTF-32), S bytes
  std::size_t item_bytes = 8;
  bool big_endian = false;

  bool is_number() const { return kind != 'U' && kind != 'S'; }
};

// Reads "<f8", ">i4", "|S6", "f4", "?". Throws DataError at `place` for what holds no plain numbers
// or text: objects (they are pickles), structures, complex numbers, dates, 16-byte floats.
NumpyType parse_numpy_type(std::string_view text, const Place& place);

// A view: the bytes belong to somebody else. Row-major unless `column_major` (numpy's Fortran
// order).
struct NumpyArray {
  NumpyType type;
  std::vector<std::size_t> shape;  // empty: a single value ("0-d")
  bool column_major = false;
  std::string_view data;

  std::size_t rows() const { return shape.empty() ? 1 : shape[0]; }
  std::size_t columns() const { return shape.size() < 2 ? 1 : shape[1]; }
  // Row-major doubles in this processor's order: the memory of such a matrix.
  bool is_plain() const;
  std::size_t dimensions() const { return shape.size(); }
  // Element of an array of at most two dimensions, as a double. The type must be a number.
  double at(std::size_t row, std::size_t column) const;
};

// "(60, 72)", as numpy prints it.
std::string shape_text(const NumpyArray& array);

// Throws DataError at `place` unless the data has exactly the bytes that shape and type ask for.
void check_array_size(const NumpyArray& array, const Place& place);

// Throws DataError unless the array is (frames, columns) of floats with 1 .. kMaxClipFrames frames;
// columns = 0 allows any number.
void check_motion_array(const NumpyArray& array, const std::string& name, std::size_t columns,
                        const Place& place);

// The only number of an array of one element (0-d, or shape (1,)). Throws DataError for others.
double single_number(const NumpyArray& array, const std::string& name, const Place& place);

// out(t, out_first + c) = array(t, first + c) for c < count.
template <class Matrix>
void copy_columns(const NumpyArray& array, std::size_t first, std::size_t count, Matrix& out,
                  Eigen::Index out_first = 0) {
  static_assert(Matrix::IsRowMajor);
  const bool plain = array.is_plain();
  for (std::size_t t = 0; t < array.rows() && plain; ++t)
    std::memcpy(&out(static_cast<Eigen::Index>(t), out_first),
                array.data.data() + sizeof(double) * (t * array.columns() + first),
                sizeof(double) * count);
  for (std::size_t t = 0; t < array.rows() && !plain; ++t)
    for (std::size_t c = 0; c < count; ++c)
      out(static_cast<Eigen::Index>(t), out_first + static_cast<Eigen::Index>(c)) =
          array.at(t, first + c);
}

}  // namespace mocaplm
