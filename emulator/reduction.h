// Curves (S, T) in a tangent space as few coefficients (section 4.2).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "common/json.h"

namespace mocaplm {

// How many components to keep: a number, or the fewest that explain a share of the variance.
struct ReductionSize {
  Eigen::Index d1 = 10, d2 = 5;
  double variance1 = 0, variance2 = 0;  // in [0, 1]; 0: as the number says
};

// Flat curves to coefficients (d1, d2), and back. A matrix of coefficients with fewer rows or
// columns is one whose others are zero: the nested approximations of figure 13.
class Reduction {
 public:
  virtual ~Reduction() = default;
  virtual Eigen::Index d1() const = 0;
  virtual Eigen::Index d2() const = 0;
  virtual Eigen::Index coordinates() const = 0;  // S
  virtual Eigen::Index frames() const = 0;       // T
  virtual Eigen::MatrixXd project(const Eigen::MatrixXd& flat) const = 0;
  virtual Eigen::MatrixXd restore(const Eigen::MatrixXd& coefficients) const = 0;
  virtual Json json() const = 0;
};

// "SequentialPCA": principal components of all columns of all curves, then of each component's
// course in time, with a mean course and a basis of its own. "MPCA": one basis in space and one in
// time for all (Lu, Plataniotis, Venetsanopoulos 2008), alternately the best for the other, of
// curves less their mean. "SpatialPCA": the first half of SequentialPCA; d2 is T.
//
// All flats are (S, T). d1 is lowered to S, d2 to T and, with SequentialPCA, to the curves less
// one. Throws DataError for values that are not finite and for curves that are all the same.
std::unique_ptr<Reduction> fit_reduction(const std::string& name,
                                         const std::vector<Eigen::MatrixXd>& flats,
                                         const ReductionSize& size, int threads = 0);
// Throws DataError naming the key.
std::unique_ptr<Reduction> read_reduction(const Json& json, const std::string& place);

const std::vector<std::string>& reduction_names();

// Matrices in files: {"rows": r, "columns": c, "values": [...]}, column after column.
Json matrix_json(const Eigen::MatrixXd& matrix);
// Throws DataError unless it is (rows, columns), -1 for any number, of finite values.
Eigen::MatrixXd read_matrix(JsonObject& object, const std::string& key, Eigen::Index rows,
                            Eigen::Index columns);

}  // namespace mocaplm
