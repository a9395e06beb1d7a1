#include "emulator/reduction.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"
#include "numeric/components.h"

namespace mocaplm {

namespace {

using Flats = std::vector<Eigen::MatrixXd>;

// The fewest of these falling variances that make up `share` of their sum.
Eigen::Index enough(const Eigen::VectorXd& variances, double share) {
  double sum = 0;
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    sum += variances[k];
    if (sum >= share * variances.sum() * (1 - 1e-12)) return k + 1;
  }
  return variances.size();
}

Eigen::VectorXd column_variances(const Eigen::MatrixXd& centred) {
  return centred.colwise().squaredNorm().transpose();
}

// Principal components of few rows of many numbers: found inside the rows' span, which is small.
Components components_of_rows(const Eigen::MatrixXd& x, Eigen::Index k) {
  if (x.rows() >= x.cols()) return principal_components(x, k);
  const Eigen::RowVectorXd mean = x.colwise().mean();
  const Eigen::MatrixXd centred = x.rowwise() - mean;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(centred.transpose());
  const Eigen::MatrixXd span = qr.householderQ() * Eigen::MatrixXd::Identity(x.cols(), x.rows());
  Components inside = principal_components(centred * span, k);
  Components all;
  all.mean = mean;
  all.analysis = span * inside.analysis;
  for (Eigen::Index c = 0; c < k; ++c) {
    Eigen::Index largest = 0;
    all.analysis.col(c).cwiseAbs().maxCoeff(&largest);
    if (all.analysis(largest, c) < 0) all.analysis.col(c) = -all.analysis.col(c);
  }
  all.synthesis = all.analysis.transpose();
  return all;
}

// The k eigenvectors of largest eigenvalue, the largest first.
Eigen::MatrixXd leading(const Eigen::MatrixXd& scatter, Eigen::Index k,
                        Eigen::VectorXd* all = nullptr) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scatter);
  if (all != nullptr) *all = eigen.eigenvalues().reverse().cwiseMax(0);
  Eigen::MatrixXd vectors = eigen.eigenvectors().rowwise().reverse().leftCols(k);
  for (Eigen::Index c = 0; c < k; ++c) {
    Eigen::Index largest = 0;
    vectors.col(c).cwiseAbs().maxCoeff(&largest);
    if (vectors(largest, c) < 0) vectors.col(c) = -vectors.col(c);
  }
  return vectors;
}

struct Spatial {
  Eigen::VectorXd mean;   // (S)
  Eigen::MatrixXd basis;  // (S, d1)

  Eigen::MatrixXd courses(const Eigen::MatrixXd& flat) const {
    return basis.transpose() * (flat.colwise() - mean);
  }
  Eigen::MatrixXd flat(const Eigen::MatrixXd& courses) const {
    return (basis.leftCols(courses.rows()) * courses).colwise() + mean;
  }
};

Spatial fit_spatial(const Flats& flats, const ReductionSize& size) {
  const Eigen::Index s = flats[0].rows(), t = flats[0].cols();
  Eigen::MatrixXd all(static_cast<Eigen::Index>(flats.size()) * t, s);
  for (std::size_t m = 0; m < flats.size(); ++m)
    all.middleRows(static_cast<Eigen::Index>(m) * t, t) = flats[m].transpose();
  const Components full = principal_components(all, s);
  Eigen::Index d1 = std::min(size.d1, s);
  if (size.variance1 > 0) d1 = enough(column_variances(full.project(all)), size.variance1);
  return {full.mean.transpose(), full.analysis.leftCols(d1)};
}

class SpatialPca : public Reduction {
 public:
  SpatialPca(Spatial spatial, Eigen::Index frames) : spatial_(std::move(spatial)), t_(frames) {}

  Eigen::Index d1() const override { return spatial_.basis.cols(); }
  Eigen::Index d2() const override { return t_; }
  Eigen::Index coordinates() const override { return spatial_.basis.rows(); }
  Eigen::Index frames() const override { return t_; }
  Eigen::MatrixXd project(const Eigen::MatrixXd& flat) const override {
    return spatial_.courses(flat);
  }
  Eigen::MatrixXd restore(const Eigen::MatrixXd& courses) const override {
    return spatial_.flat(courses);
  }
  Json json() const override {
    return {{"reduction", "SpatialPCA"},
            {"frames", t_},
            {"mean", matrix_json(spatial_.mean)},
            {"basis", matrix_json(spatial_.basis)}};
  }

 private:
  Spatial spatial_;
  Eigen::Index t_;
};

// The course of each spatial component: (d1) means (T) and bases (T, d2).
class SequentialPca : public Reduction {
 public:
  SequentialPca(Spatial spatial, Eigen::MatrixXd means, std::vector<Eigen::MatrixXd> bases)
      : spatial_(std::move(spatial)), means_(std::move(means)), bases_(std::move(bases)) {}

  Eigen::Index d1() const override { return spatial_.basis.cols(); }
  Eigen::Index d2() const override { return bases_[0].cols(); }
  Eigen::Index coordinates() const override { return spatial_.basis.rows(); }
  Eigen::Index frames() const override { return means_.cols(); }

  Eigen::MatrixXd project(const Eigen::MatrixXd& flat) const override {
    const Eigen::MatrixXd courses = spatial_.courses(flat) - means_;
    Eigen::MatrixXd coefficients(d1(), d2());
    for (Eigen::Index i = 0; i < d1(); ++i)
      coefficients.row(i) = courses.row(i) * bases_[static_cast<std::size_t>(i)];
    return coefficients;
  }

  Eigen::MatrixXd restore(const Eigen::MatrixXd& coefficients) const override {
    Eigen::MatrixXd courses(coefficients.rows(), frames());
    for (Eigen::Index i = 0; i < coefficients.rows(); ++i)
      courses.row(i) =
          means_.row(i) +
          coefficients.row(i) *
              bases_[static_cast<std::size_t>(i)].leftCols(coefficients.cols()).transpose();
    return spatial_.flat(courses);
  }

  Json json() const override {
    Json bases = Json::array();
    for (const Eigen::MatrixXd& basis : bases_) bases.push_back(matrix_json(basis));
    return {{"reduction", "SequentialPCA"},
            {"mean", matrix_json(spatial_.mean)},
            {"basis", matrix_json(spatial_.basis)},
            {"means", matrix_json(means_)},
            {"bases", bases}};
  }

 private:
  Spatial spatial_;
  Eigen::MatrixXd means_;  // (d1, T)
  std::vector<Eigen::MatrixXd> bases_;
};

std::unique_ptr<Reduction> fit_sequential(const Flats& flats, const ReductionSize& size,
                                          int threads) {
  Spatial spatial = fit_spatial(flats, size);
  const Eigen::Index d1 = spatial.basis.cols(), t = flats[0].cols();
  const auto m = static_cast<Eigen::Index>(flats.size());
  std::vector<Eigen::MatrixXd> courses(static_cast<std::size_t>(d1), Eigen::MatrixXd(m, t));
  for (Eigen::Index k = 0; k < m; ++k) {
    const Eigen::MatrixXd all = spatial.courses(flats[static_cast<std::size_t>(k)]);
    for (Eigen::Index i = 0; i < d1; ++i) courses[static_cast<std::size_t>(i)].row(k) = all.row(i);
  }
  const Eigen::Index most = std::min(t, m - 1);
  std::vector<Components> components(courses.size());
  Eigen::MatrixXd variances(most, d1);
  parallel_for(courses.size(), threads, [&](std::size_t i) {
    components[i] = components_of_rows(courses[i], most);
    variances.col(static_cast<Eigen::Index>(i)) =
        column_variances(components[i].project(courses[i]));
  });
  Eigen::Index d2 = std::min(size.d2, most);
  if (size.variance2 > 0) d2 = enough(variances.rowwise().sum(), size.variance2);
  Eigen::MatrixXd means(d1, t);
  std::vector<Eigen::MatrixXd> bases;
  for (std::size_t i = 0; i < courses.size(); ++i) {
    means.row(static_cast<Eigen::Index>(i)) = components[i].mean;
    bases.push_back(components[i].analysis.leftCols(d2));
  }
  return std::make_unique<SequentialPca>(std::move(spatial), std::move(means), std::move(bases));
}

class Mpca : public Reduction {
 public:
  Mpca(Eigen::MatrixXd mean, Eigen::MatrixXd space, Eigen::MatrixXd time)
      : mean_(std::move(mean)), space_(std::move(space)), time_(std::move(time)) {}

  Eigen::Index d1() const override { return space_.cols(); }
  Eigen::Index d2() const override { return time_.cols(); }
  Eigen::Index coordinates() const override { return mean_.rows(); }
  Eigen::Index frames() const override { return mean_.cols(); }
  Eigen::MatrixXd project(const Eigen::MatrixXd& flat) const override {
    return space_.transpose() * (flat - mean_) * time_;
  }
  Eigen::MatrixXd restore(const Eigen::MatrixXd& coefficients) const override {
    return mean_ + space_.leftCols(coefficients.rows()) * coefficients *
                       time_.leftCols(coefficients.cols()).transpose();
  }
  Json json() const override {
    return {{"reduction", "MPCA"},
            {"mean", matrix_json(mean_)},
            {"space", matrix_json(space_)},
            {"time", matrix_json(time_)}};
  }

 private:
  Eigen::MatrixXd mean_;   // (S, T)
  Eigen::MatrixXd space_;  // (S, d1)
  Eigen::MatrixXd time_;   // (T, d2)
};

std::unique_ptr<Reduction> fit_mpca(const Flats& flats, const ReductionSize& size) {
  const Eigen::Index s = flats[0].rows(), t = flats[0].cols();
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(s, t);
  for (const Eigen::MatrixXd& flat : flats) mean += flat / static_cast<double>(flats.size());
  // The scatter of one way, of curves that the other way's basis has made narrow.
  const auto in_space = [&](const Eigen::MatrixXd& time) {
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(s, s);
    for (const Eigen::MatrixXd& flat : flats) {
      const Eigen::MatrixXd narrow = (flat - mean) * time;
      scatter += narrow * narrow.transpose();
    }
    return scatter;
  };
  const auto in_time = [&](const Eigen::MatrixXd& space) {
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(t, t);
    for (const Eigen::MatrixXd& flat : flats) {
      const Eigen::MatrixXd narrow = space.transpose() * (flat - mean);
      scatter += narrow.transpose() * narrow;
    }
    return scatter;
  };
  // Lu's full projection truncation to begin with, which also chooses the sizes.
  Eigen::Index d1 = std::min(size.d1, s), d2 = std::min(size.d2, t);
  Eigen::VectorXd variances;
  leading(in_space(Eigen::MatrixXd::Identity(t, t)), d1, &variances);
  if (size.variance1 > 0) d1 = enough(variances, size.variance1);
  Eigen::MatrixXd time = leading(in_time(Eigen::MatrixXd::Identity(s, s)), d2, &variances);
  if (size.variance2 > 0)
    time =
        leading(in_time(Eigen::MatrixXd::Identity(s, s)), d2 = enough(variances, size.variance2));
  Eigen::MatrixXd space;
  double captured = 0;
  for (int round = 0; round < 20; ++round) {
    space = leading(in_space(time), d1);
    time = leading(in_time(space), d2, &variances);
    const double now = variances.head(d2).sum();
    if (now - captured <= 1e-9 * now) break;
    captured = now;
  }
  return std::make_unique<Mpca>(std::move(mean), std::move(space), std::move(time));
}

void check_flats(const Flats& flats) {
  if (flats.size() < 3)
    throw DataError(
        in_file("motions"),
        std::to_string(flats.size()) + " to fit to; components and their variances need 3 or more");
  double spread = 0;
  for (const Eigen::MatrixXd& flat : flats) {
    if (!flat.allFinite()) throw DataError(in_file("motions"), "the values are not all finite");
    if (flat.rows() != flats[0].rows() || flat.cols() != flats[0].cols())
      throw UsageError("curves to be reduced must have the same coordinates and frames");
    spread = std::max(spread, (flat - flats[0]).cwiseAbs().maxCoeff());
  }
  if (spread < 1e-9)
    throw DataError(in_file("motions"), "all are the same: there is no variation to emulate");
}

}  // namespace

const std::vector<std::string>& reduction_names() {
  static const std::vector<std::string> names = {"SequentialPCA", "MPCA", "SpatialPCA"};
  return names;
}

std::unique_ptr<Reduction> fit_reduction(const std::string& name, const Flats& flats,
                                         const ReductionSize& size, int threads) {
  check_flats(flats);
  if (name == "SequentialPCA") return fit_sequential(flats, size, threads);
  if (name == "MPCA") return fit_mpca(flats, size);
  if (name == "SpatialPCA")
    return std::make_unique<SpatialPca>(fit_spatial(flats, size), flats[0].cols());
  throw UsageError("unknown reduction \"" + name + "\"" + known_names(name, reduction_names()));
}

std::unique_ptr<Reduction> read_reduction(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  const std::string name = object.choice("reduction", reduction_names());
  if (name == "MPCA") {
    Eigen::MatrixXd mean = read_matrix(object, "mean", -1, -1);
    Eigen::MatrixXd space = read_matrix(object, "space", mean.rows(), -1);
    Eigen::MatrixXd time = read_matrix(object, "time", mean.cols(), -1);
    object.finish();
    return std::make_unique<Mpca>(std::move(mean), std::move(space), std::move(time));
  }
  Spatial spatial;
  spatial.mean = read_matrix(object, "mean", -1, 1);
  spatial.basis = read_matrix(object, "basis", spatial.mean.rows(), -1);
  if (name == "SpatialPCA") {
    const std::int64_t frames = object.integer("frames", 2, 1000000);
    object.finish();
    return std::make_unique<SpatialPca>(std::move(spatial), frames);
  }
  Eigen::MatrixXd means = read_matrix(object, "means", spatial.basis.cols(), -1);
  std::vector<Eigen::MatrixXd> bases;
  const Json& list = object.raw("bases");
  if (!list.is_array() || static_cast<Eigen::Index>(list.size()) != spatial.basis.cols())
    object.fail("bases", "expected a list of as many bases as spatial components");
  for (const Json& basis : list) {
    Json one = {{"basis", basis}};
    JsonObject each(one, place + ": bases");
    bases.push_back(read_matrix(each, "basis", means.cols(), bases.empty() ? -1 : bases[0].cols()));
  }
  object.finish();
  return std::make_unique<SequentialPca>(std::move(spatial), std::move(means), std::move(bases));
}

Json matrix_json(const Eigen::MatrixXd& matrix) {
  return {{"rows", matrix.rows()},
          {"columns", matrix.cols()},
          {"values", std::vector<double>(matrix.data(), matrix.data() + matrix.size())}};
}

Eigen::MatrixXd read_matrix(JsonObject& object, const std::string& key, Eigen::Index rows,
                            Eigen::Index columns) {
  JsonObject matrix = object.object(key);
  const std::int64_t r = matrix.integer("rows", 1, 100000000);
  const std::int64_t c = matrix.integer("columns", 1, 100000000);
  const std::vector<double> values = matrix.numbers("values");
  matrix.finish();
  if ((rows >= 0 && r != rows) || (columns >= 0 && c != columns) ||
      values.size() / static_cast<std::size_t>(r) != static_cast<std::size_t>(c) ||
      values.size() % static_cast<std::size_t>(r) != 0)
    object.fail(key, "a matrix of " + std::to_string(r) + " x " + std::to_string(c) + " with " +
                         std::to_string(values.size()) + " values, expected " +
                         (rows < 0 ? "any" : std::to_string(rows)) + " x " +
                         (columns < 0 ? "any" : std::to_string(columns)));
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), r, c);
}

}  // namespace mocaplm
