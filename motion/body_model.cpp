#include "motion/body_model.h"

#include <cmath>
#include <map>
#include <mutex>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/array_dict.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxVertices = 1000000;

struct Weight {
  std::size_t joint = 0, vertex = 0;
  double value = 0;
};

// Any element by its place in row-major order.
double element(const NumpyArray& array, const std::vector<std::size_t>& index) {
  std::size_t at = 0;
  for (std::size_t d = 0; d < index.size(); ++d) {
    const std::size_t k = array.column_major ? index.size() - 1 - d : d;
    at = at * array.shape[k] + index[k];
  }
  NumpyArray flat = array;
  flat.shape = {array.data.size() / array.type.item_bytes, 1};
  flat.column_major = false;
  return flat.at(at, 0);
}

NumpyArray numbers(const ArrayDict& dict, const std::string& key, std::size_t dimensions) {
  if (!dict.has(key))
    throw DataError(in_file(dict.file()), "has no " + key + ", only " + dict.contents() +
                                              "; expected an SMPL, SMPL+H or SMPL-X model file");
  const NumpyArray array = dict.array(key);
  if (!array.type.is_number() || array.dimensions() != dimensions)
    throw DataError(dict.place(key), key + " has the shape " + shape_text(array) + ", expected " +
                                         std::to_string(dimensions) + " dimensions of numbers");
  return array;
}

// scipy's compressed columns or rows: data, indices, indptr.
std::vector<Weight> sparse_weights(const ArrayDict& sparse, std::size_t vertices,
                                   std::size_t& joints) {
  const NumpyArray data = numbers(sparse, "data", 1), indices = numbers(sparse, "indices", 1),
                   starts = numbers(sparse, "indptr", 1);
  const NumpyArray shape = sparse.array(sparse.has("_shape") ? "_shape" : "shape");
  const auto fail = [&] {
    throw DataError(in_file(sparse.file()), "J_regressor is a sparse matrix that does not add up");
  };
  if (shape.rows() != 2 || shape.at(1, 0) != static_cast<double>(vertices)) fail();
  joints =
      shape.at(0, 0) >= 0 && shape.at(0, 0) < 1000 ? static_cast<std::size_t>(shape.at(0, 0)) : 0;
  const bool by_columns = starts.rows() == vertices + 1;
  if ((!by_columns && starts.rows() != joints + 1) || data.rows() != indices.rows()) fail();
  std::vector<Weight> weights;
  for (std::size_t line = 0; line + 1 < starts.rows(); ++line) {
    const double first = starts.at(line, 0), end = starts.at(line + 1, 0);
    if (!(first >= 0 && first <= end && end <= static_cast<double>(data.rows()))) fail();
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
      const double other = indices.at(i, 0);
      if (!(other >= 0 && other < static_cast<double>(by_columns ? joints : vertices))) fail();
      const auto k = static_cast<std::size_t>(other);
      weights.push_back({by_columns ? k : line, by_columns ? line : k, data.at(i, 0)});
    }
  }
  return weights;
}

std::vector<Weight> weights_of(const ArrayDict& dict, std::size_t vertices, std::size_t& joints) {
  if (const auto sparse = dict.dict("J_regressor"); sparse && sparse->has("indptr"))
    return sparse_weights(*sparse, vertices, joints);
  const NumpyArray dense = numbers(dict, "J_regressor", 2);
  joints = dense.rows();
  if (dense.columns() != vertices)
    throw DataError(dict.place("J_regressor"), "J_regressor has the shape " + shape_text(dense) +
                                                   ", but there are " + std::to_string(vertices) +
                                                   " vertices");
  std::vector<Weight> weights;
  for (std::size_t j = 0; j < joints && joints < 1000; ++j)
    for (std::size_t v = 0; v < vertices; ++v)
      if (const double value = dense.at(j, v); value != 0) weights.push_back({j, v, value});
  return weights;
}

// The model's joint for each of SMPL's 24; its hands lie at the base of the middle finger in models
// with fingers.
std::size_t model_joint(std::size_t joint, std::size_t joints) {
  if (joint < 22 || joints == 24) return joint;
  const std::size_t left = joints == 52 ? 25 : 28;  // SMPL-X has the jaw and the eyes before
  return joint == 22 ? left : left + 15;
}

std::size_t shape_coefficients(std::size_t all, std::size_t joints) {
  if (joints != 55) return all;
  if (all == 400) return 300;  // 100 expressions follow
  return all == 20 ? 10 : std::min<std::size_t>(all, 300);
}

}  // namespace

BodyModel::BodyModel(const std::filesystem::path& path) {
  const ArrayDict dict = ArrayDict::open(path);
  const NumpyArray vertices = numbers(dict, "v_template", 2);
  const NumpyArray directions = numbers(dict, "shapedirs", 3);
  const std::size_t count = vertices.rows();
  if (vertices.columns() != 3 || count == 0 || count > kMaxVertices ||
      directions.shape[0] != count || directions.shape[1] != 3)
    throw DataError(dict.place("shapedirs"), "shapedirs has the shape " + shape_text(directions) +
                                                 " and v_template " + shape_text(vertices) +
                                                 ", expected (V, 3, B) and (V, 3)");
  std::size_t joints = 0;
  const std::vector<Weight> weights = weights_of(dict, count, joints);
  if (joints != 24 && joints != 52 && joints != 55)
    throw DataError(dict.place("J_regressor"),
                    "J_regressor gives " + std::to_string(joints) +
                        " joints, expected 24 (SMPL), 52 (SMPL+H) or 55 (SMPL-X)");
  const std::size_t coefficients = shape_coefficients(directions.shape[2], joints);
  mean_.setZero();
  change_.setZero(72, static_cast<Eigen::Index>(coefficients));
  for (std::size_t j = 0; j < 24; ++j)
    for (const Weight& weight : weights) {
      if (weight.joint != model_joint(j, joints)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<Eigen::Index>(3 * j + axis);
        mean_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(axis)) +=
            weight.value * vertices.at(weight.vertex, axis);
        for (std::size_t b = 0; b < coefficients; ++b)
          change_(row, static_cast<Eigen::Index>(b)) +=
              weight.value * element(directions, {weight.vertex, axis, b});
      }
    }
  // A body is a few metres and a coefficient changes it by centimetres.
  if (!(mean_.cwiseAbs().maxCoeff() < 10) ||
      (coefficients > 0 && !(change_.cwiseAbs().maxCoeff() < 10)))
    throw DataError(in_file(path.string()), "gives joints that lie more than 10 metres away");
}

RestJoints BodyModel::joints(const std::vector<double>& betas) const {
  RestJoints joints = mean_;
  const std::size_t used = std::min(betas.size(), coefficients());
  for (std::size_t b = 0; b < used; ++b)
    for (Eigen::Index row = 0; row < 72; ++row)
      joints(row / 3, row % 3) += betas[b] * change_(row, static_cast<Eigen::Index>(b));
  return joints;
}

std::shared_ptr<const BodyModel> body_model(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const BodyModel>> read;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<const BodyModel>& model = read[path];
  if (model == nullptr) model = std::make_shared<const BodyModel>(path);
  return model;
}

}  // namespace mocaplm
