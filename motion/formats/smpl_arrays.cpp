#include "motion/formats/smpl_arrays.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "motion/rotation.h"

namespace mocaplm {

namespace {

constexpr double kRounded = 0.02;  // how far a matrix of a network may be from a rotation
constexpr std::size_t kMaxBetas = 400;

// Without leading and inner dimensions of one, which batches leave behind. The first one that stays
// is the frames.
std::vector<std::size_t> trimmed(const std::vector<std::size_t>& shape, std::size_t keep) {
  std::vector<std::size_t> out = shape;
  while (out.size() > keep && out[0] == 1) out.erase(out.begin());
  return out;
}

void check_numbers(const NumpyArray& array, const std::string& key, const Place& place) {
  if (array.type.kind != 'f')
    throw DataError(place, key + " holds elements of kind '" + std::string(1, array.type.kind) +
                               "', expected floating-point numbers");
  std::size_t count = 1;
  for (const std::size_t n : array.shape) count *= n;
  if (count == 0) throw DataError(place, key + " has no frames");
  if (array.column_major && array.dimensions() > 2)
    throw DataError(place, key + " has the shape " + shape_text(array) +
                               " in Fortran order, which is read up to two dimensions");
}

// All values, row after row.
std::vector<double> values_of(const NumpyArray& array) {
  NumpyArray flat = array;
  if (array.dimensions() != 2) {
    std::size_t count = 1;
    for (const std::size_t n : array.shape) count *= n;
    flat.shape = {count, 1};
    flat.column_major = false;
  }
  RotationVectors all(static_cast<Eigen::Index>(flat.rows()),
                      static_cast<Eigen::Index>(flat.columns()));
  copy_columns(flat, 0, flat.columns(), all);
  return {all.data(), all.data() + all.size()};
}

void check_frames(std::size_t frames, const std::string& key, const Place& place) {
  if (frames > kMaxClipFrames)
    throw DataError(place, key + " has " + std::to_string(frames) +
                               " frames, more than the limit of " + std::to_string(kMaxClipFrames) +
                               "; cut it into several clips");
}

Eigen::Vector3d vector_of_matrix(const double* m, const std::string& key, const Place& place) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> matrix(m);
  const Eigen::Matrix3d square = matrix * matrix.transpose();
  if (!((square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kRounded) ||
      matrix.determinant() < 0)
    throw DataError(place, key + " holds a matrix that is no rotation");
  return axis_angle_from_matrix(quaternion_from_matrix(matrix).normalized().toRotationMatrix());
}

// What one row of (N, ...) is: `joints`, as rotation vectors or matrices; joints = 0: none of
// these.
struct Form {
  std::size_t joints = 0;
  bool matrices = false;
};

Form form_of(const std::vector<std::size_t>& row, const std::vector<std::size_t>& allowed) {
  const auto known = [&](std::size_t joints) {
    return std::find(allowed.begin(), allowed.end(), joints) != allowed.end();
  };
  const std::size_t d = row.size();
  if (d == 1 && row[0] % 3 == 0 && known(row[0] / 3)) return {row[0] / 3, false};
  if (d == 2 && row[0] == 3 && row[1] == 3 && known(1)) return {1, true};
  if (d == 2 && row[1] == 3 && known(row[0])) return {row[0], false};
  if (d == 3 && row[1] == 3 && row[2] == 3 && known(row[0])) return {row[0], true};
  if (d == 2 && row[1] == 9 && known(row[0])) return {row[0], true};
  if (d == 1 && row[0] % 9 == 0 && known(row[0] / 9)) return {row[0] / 9, true};
  return {};
}

std::string other_form(const std::vector<std::size_t>& row) {
  const std::size_t last = row.empty() ? 0 : row.back();
  if (row.size() == 2 && last == 6) return " (6-d rotations, whose order programs disagree on)";
  if (row.size() == 2 && last == 4) return " (quaternions, whose order programs disagree on)";
  if (row.size() == 1 && (last == 263 || last == 251))
    return " (HumanML3D's features, not rotations)";
  if (row.size() == 1 && (last == 144 || last == 132))
    return " (6-d rotations, whose order programs disagree on)";
  return "";
}

}  // namespace

RotationVectors read_rotations(const ArrayDict& dict, const std::string& key,
                               const std::vector<std::size_t>& allowed) {
  const NumpyArray array = dict.array(key);
  const Place place = dict.place(key);
  check_numbers(array, key, place);
  Form form;
  std::size_t frames = 0;
  // (1, N, J, 3) is a batch of one; (1, J, 3) is one frame. As it stands comes first.
  for (std::size_t drop = 0; drop < array.dimensions() && form.joints == 0; ++drop) {
    if (drop > 0 && array.shape[drop - 1] != 1) break;
    std::vector<std::size_t> row(array.shape.begin() + static_cast<std::ptrdiff_t>(drop) + 1,
                                 array.shape.end());
    form = form_of(row, allowed);
    // (N, 1, J, 3): an inner batch.
    if (form.joints == 0 && row.size() > 1 && row[0] == 1)
      form = form_of({row.begin() + 1, row.end()}, allowed);
    frames = array.shape[drop];
  }
  // (3,), (72,), (J, 3): a single frame without its dimension.
  if (form.joints == 0) {
    form = form_of(array.shape, allowed);
    frames = 1;
  }
  if (form.joints == 0) {
    std::vector<std::string> sizes;
    for (const std::size_t joints : allowed) sizes.push_back(std::to_string(joints));
    const auto shape = trimmed(array.shape, 1);
    const std::vector<std::size_t> row =
        shape.empty() ? shape : std::vector<std::size_t>(shape.begin() + 1, shape.end());
    throw DataError(place,
                    key + " has the shape " + shape_text(array) + other_form(row) +
                        ", expected (frames, 3 J), (frames, J, 3) or (frames, J, 3, 3) with J = " +
                        join(sizes, ", ") + " joints");
  }
  check_frames(frames, key, place);
  RotationVectors out(static_cast<Eigen::Index>(frames),
                      static_cast<Eigen::Index>(3 * form.joints));
  if (array.dimensions() == 2 && array.columns() == 3 * form.joints && !form.matrices) {
    copy_columns(array, 0, array.columns(), out);
    return out;
  }
  const std::vector<double> values = values_of(array);
  if (!form.matrices) {
    std::copy(values.begin(), values.end(), out.data());
    return out;
  }
  for (std::size_t i = 0; i < frames * form.joints; ++i) {
    const Place where = in_file(place.file + ": frame " + std::to_string(i / form.joints) +
                                ", rotation " + std::to_string(i % form.joints));
    Eigen::Map<Eigen::Vector3d>(out.data() + 3 * i) = vector_of_matrix(&values[9 * i], key, where);
  }
  return out;
}

Translations read_translations(const ArrayDict& dict, const std::string& key) {
  const NumpyArray array = dict.array(key);
  const Place place = dict.place(key);
  check_numbers(array, key, place);
  std::vector<std::size_t> shape = trimmed(array.shape, 2);
  if (shape.size() == 3 && shape[1] == 1) shape.erase(shape.begin() + 1);
  if (shape.size() == 1 && shape[0] == 3) shape.insert(shape.begin(), 1);
  if (shape.size() != 2 || shape[1] != 3)
    throw DataError(place, key + " has the shape " + shape_text(array) + ", expected (frames, 3)");
  check_frames(shape[0], key, place);
  const std::vector<double> values = values_of(array);
  Translations out(static_cast<Eigen::Index>(shape[0]), 3);
  std::copy(values.begin(), values.end(), out.data());
  return out;
}

std::vector<double> read_betas(const ArrayDict& dict, const std::string& key, bool& differ) {
  const NumpyArray array = dict.array(key);
  const Place place = dict.place(key);
  if (!array.type.is_number() || array.dimensions() == 0) return {};
  std::vector<std::size_t> shape = trimmed(array.shape, 1);
  if (array.column_major && array.dimensions() > 2) return {};
  if (shape.size() == 3 && shape[1] == 1) shape.erase(shape.begin() + 1);
  const std::size_t count = shape.empty() ? 0 : shape.back();
  const std::size_t rows = shape.size() == 2 ? shape[0] : 1;
  if (shape.empty() || shape.size() > 2 || count > kMaxBetas)
    throw DataError(place, key + " has the shape " + shape_text(array) +
                               ", expected up to 400 coefficients of the body's shape");
  if (count == 0 || rows == 0) return {};
  const std::vector<double> values = values_of(array);
  std::vector<double> mean(count, 0.0);
  for (std::size_t i = 0; i < rows * count; ++i) {
    if (!(std::abs(values[i]) < 1e6))
      throw DataError(
          place, key + " holds " + format_number(values[i]) + ", expected finite coefficients");
    if (std::abs(values[i] - values[i % count]) > 1e-6) differ = true;
  }
  for (std::size_t i = 0; i < rows * count; ++i) mean[i % count] += values[i];
  for (std::size_t b = 0; b < count; ++b)
    mean[b] = differ ? mean[b] / static_cast<double>(rows) : values[b];
  return mean;
}

}  // namespace mocaplm
