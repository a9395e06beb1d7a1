// Joints of a body's own shape, from the SMPL, SMPL+H or SMPL-X model file that its licensors give
// (.npz, or .pkl with chumpy's and scipy's arrays; Loper et al. 2015, Romero et al. 2017, Pavlakos
// et al. 2019):
//   v_template   (V, 3) the mean body's vertices, metres
//   shapedirs    (V, 3, B) what each coefficient of the shape adds; SMPL-X's expressions, which
//   follow
//                300 (or 10) of the shape, are left out
//   J_regressor  (24 | 52 | 55, V) joints from vertices, dense or sparse
// The joints are J_regressor (v_template + shapedirs betas).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/clip.h"

namespace mocaplm {

class BodyModel {
 public:
  // Throws DataError naming file and key.
  explicit BodyModel(const std::filesystem::path& path);

  // SMPL's 24 joints for this shape; coefficients beyond the model's are left out, missing ones are
  // 0. SMPL+H and SMPL-X have no hand joints: the base of the middle finger stands for them.
  RestJoints joints(const std::vector<double>& betas) const;
  std::size_t coefficients() const { return static_cast<std::size_t>(change_.cols()); }

 private:
  RestJoints mean_;
  Eigen::Matrix<double, 72, Eigen::Dynamic> change_;  // row 3 * joint + axis, for each coefficient
};

// The model of a file, read once.
std::shared_ptr<const BodyModel> body_model(const std::string& path);

}  // namespace mocaplm
