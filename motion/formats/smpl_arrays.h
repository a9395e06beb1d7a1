// Arrays of rotations, positions and shapes in the many forms that programs give them, as ours.
#pragma once

#include <string>
#include <vector>

#include "motion/clip.h"
#include "motion/formats/array_dict.h"

namespace mocaplm {

// (frames, 3 * joints) rotation vectors in radians.
using RotationVectors = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// How many joints the rotations of `key` have, by their shape: (N, 3 J), (N, J, 3), (N, J, 3, 3),
// (N, 9 J), each also with a leading 1; `allowed` are the J that make sense. For one joint also (N,
// 3) and (N, 3, 3). Throws DataError naming the shape.
RotationVectors read_rotations(const ArrayDict& dict, const std::string& key,
                               const std::vector<std::size_t>& allowed);

// (N, 3), (N, 1, 3) or (1, N, 3).
Translations read_translations(const ArrayDict& dict, const std::string& key);

// SMPL's shape coefficients: (B,), or (N, B) of N frames, whose mean is taken where they differ
// (`differ` is set).
std::vector<double> read_betas(const ArrayDict& dict, const std::string& key, bool& differ);

}  // namespace mocaplm
