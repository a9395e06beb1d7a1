#include "spectral/interpolate/interpolate.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/error.h"
#include "common/text.h"
#include "motion/resample.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"
#include "numeric/components.h"
#include "numeric/dct.h"
#include "numeric/stft.h"
#include "spectral/measures.h"

namespace mocaplm {

namespace {

constexpr double kManyTurns = 201.0619298297467;  // 64 pi
constexpr double kLeastMagnitude = 1e-12;         // squared: the root's slope at 0 has no end
using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
using FeatureFunction = std::function<torch::Tensor(const torch::Tensor&)>;  // of x (T, 72)

torch::Tensor tensor_of(const Eigen::Ref<const RowMajor>& matrix) {
  const RowMajor plain = matrix;
  return torch::from_blob(const_cast<double*>(plain.data()), {plain.rows(), plain.cols()},
                          torch::kFloat64)
      .clone();
}

// B's vectors run on from those nearest to A's first ones, so that the way between them is short.
Clip unwound_beside(const Clip& clip, const Clip& a) {
  Clip out = clip;
  for (int j = 0; j < kJoints; ++j) {
    const Eigen::Vector3d first = clip.poses.row(0).segment<3>(3 * j).transpose();
    const Eigen::Vector3d beside = a.poses.row(0).segment<3>(3 * j).transpose();
    out.poses.row(0).segment<3>(3 * j) =
        continuous_axis_angle(first, beside, kManyTurns).transpose();
  }
  keep_continuous(out, kManyTurns);
  return out;
}

// Rows of a transform whose frequency k * step lies in the range.
std::pair<Eigen::Index, Eigen::Index> rows_in_range(double step, Eigen::Index rows,
                                                    const InterpolateConfig& config) {
  const double first = std::ceil(config.from_hz / step - 1e-9);
  const double last = std::min(std::floor(config.to_hz / step + 1e-9) + 1, double(rows));
  if (!(first < last))
    throw UsageError("no frequency of the " + config.target + " lies from from_hz " +
                     format_number(config.from_hz) + " to to_hz " + format_number(config.to_hz) +
                     ": it has multiples of " + format_fixed(step, 3) + " Hz");
  return {static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(last - first)};
}

FeatureFunction dct_function(Eigen::Index frames, const InterpolateConfig& config) {
  const auto [first, count] =
      rows_in_range(config.fps / (2 * static_cast<double>(frames)), frames, config);
  const torch::Tensor basis = tensor_of(dct_rows(frames, first, count));
  return [basis](const torch::Tensor& x) { return basis.matmul(x); };
}

FeatureFunction stft_function(const InterpolateConfig& config) {
  const Eigen::Index n = config.stft_window, bins = stft_bins(n), hop = config.hop();
  const auto [first, count] = rows_in_range(config.fps / static_cast<double>(n), bins, config);
  Eigen::MatrixXd basis(2 * count, n);
  const Eigen::MatrixXd all = stft_basis(n);
  basis << all.middleRows(first, count), all.middleRows(bins + first, count);
  // A sample's squares in all frames and bins add to at most n times its windows' squares.
  const Eigen::VectorXd window = hann_window(n);
  double most = 0;
  for (Eigen::Index t = 0; t < hop; ++t) {
    double sum = 0;
    for (Eigen::Index u = t; u < n; u += hop) sum += window[u] * window[u];
    most = std::max(most, sum);
  }
  basis /= std::sqrt(static_cast<double>(n) * std::max(most, 1e-12));
  const torch::Tensor columns = tensor_of(basis.transpose());  // (n, 2 count)
  const std::int64_t half = count;
  return [columns, n, hop, half](const torch::Tensor& x) {
    const torch::Tensor parts = x.unfold(0, n, hop).matmul(columns);  // (frames, 72, 2 count)
    return (parts.narrow(2, 0, half).square() + parts.narrow(2, half, half).square() +
            kLeastMagnitude)
        .sqrt();
  };
}

FeatureFunction pca_function(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  if (config.coefficients > a.frames())
    throw UsageError("coefficients is " + std::to_string(config.coefficients) +
                     ", more than the motions' " + std::to_string(a.frames()) + " frames");
  Eigen::MatrixXd courses(144, a.frames());
  courses << a.poses.transpose(), b.poses.transpose();
  const Components components = principal_components(courses, config.coefficients);
  const torch::Tensor basis = tensor_of(components.synthesis);
  const torch::Tensor mean = tensor_of(components.mean.transpose());
  return [basis, mean](const torch::Tensor& x) { return basis.matmul(x - mean); };
}

FeatureFunction feature_function(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  if (config.target == "dct") return dct_function(a.frames(), config);
  if (config.target == "pca") return pca_function(a, b, config);
  if (a.frames() < config.stft_window)
    throw DataError(in_file(a.name), "the motions have " + std::to_string(a.frames()) +
                                         " frames in common, fewer than a Hann window of " +
                                         std::to_string(config.stft_window));
  return stft_function(config);
}

double cosine(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double lengths = a.norm() * b.norm();
  return lengths > 0 ? a.cwiseProduct(b).sum() / lengths : 0;
}

template <class Transform>
Similarities similarities(const InterpolateResult& result, const Transform& transform) {
  const Eigen::MatrixXd o = transform(result.original), t = transform(result.target),
                        i = transform(result.result);
  return {cosine(o, t), cosine(i, o), cosine(i, t)};
}

void compare(InterpolateResult& result, const InterpolateConfig& config) {
  const auto stft = [&](const Clip& clip) -> Eigen::MatrixXd {
    if (clip.frames() < config.stft_window) return Eigen::MatrixXd::Zero(1, 1);
    return stft_magnitudes<double>(RowMajor(clip.poses), stft_basis(config.stft_window),
                                   config.hop());
  };
  result.stft = similarities(result, stft);
  // The orthonormal DCT keeps products: the courses give the same cosines.
  result.dct = similarities(result, [](const Clip& clip) { return Eigen::MatrixXd(clip.poses); });
}

}  // namespace

InterpolateResult interpolate(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  InterpolateResult result;
  result.original = resample(a, config.fps);
  result.target = resample(b, config.fps);
  const Eigen::Index frames = std::min(result.original.frames(), result.target.frames());
  if (frames < 2)
    throw DataError(in_file((a.frames() < b.frames() ? a : b).name),
                    "has one frame: there is no movement to interpolate");
  result.original = unwound(slice(result.original, 0, frames));
  result.target = unwound_beside(slice(result.target, 0, frames), result.original);

  const FeatureFunction f = feature_function(result.original, result.target, config);
  torch::Tensor x = tensor_of(result.original.poses);
  const torch::Tensor from = f(x).detach(), to = f(tensor_of(result.target.poses)).detach();
  const auto error = [&] { return (f(x) - to).square().mean().item<double>(); };
  result.features = from.numel();
  result.error_before = error();
  for (std::int64_t step = 0; step < config.steps; ++step) {
    x = x.detach().requires_grad_(true);
    const torch::Tensor features = f(x);
    const torch::Tensor loss = config.weight * (features - to).square().sum() +
                               (1 - config.weight) * (features - from).square().sum();
    loss.backward();
    x = x.detach() - 0.5 * config.rate * x.grad();
  }
  x = x.detach().contiguous();
  result.error_after = error();
  result.result = result.original;
  result.result.name = result.original.name + " towards " + result.target.name;
  result.result.poses = Eigen::Map<const Poses>(x.data_ptr<double>(), frames, 72);
  if (!result.result.poses.allFinite())
    throw UsageError("the descent left all bounds: give a smaller --rate");
  compare(result, config);
  result.result = wound(result.result);
  return result;
}

Table interpolate_table(const InterpolateResult& result, const InterpolateConfig& config) {
  Table table(result.original.name + " towards " + result.target.name + ", by " + config.target,
              {"motion", "roughness m/s^3", "above 8 Hz %", "STFT cosine to O", "to T",
               "DCT cosine to O", "DCT to T"});
  table.digits({-1, 2, 3, 3, 3, 3, 3});
  const auto row = [&](const char* name, const Clip& clip, double so, double st, double d_o,
                       double dt) {
    table.row({name, roughness(clip), 100 * fast_share(clip), so, st, d_o, dt});
  };
  const Similarities &s = result.stft, &d = result.dct;
  row("original (O)", result.original, 1, s.original_target, 1, d.original_target);
  row("target (T)", result.target, s.original_target, 1, d.original_target, 1);
  row("interpolated (I)", result.result, s.result_original, s.result_target, d.result_original,
      d.result_target);
  table.note("STFT cosines (Table 3.3): O-T " + format_fixed(s.original_target, 3) + ", I-O " +
             format_fixed(s.result_original, 3) + ", I-T " + format_fixed(s.result_target, 3));
  table.note("mean squared error of " + std::to_string(result.features) + " features: " +
             format_number(result.error_before) + " before, " + format_number(result.error_after) +
             " after " + std::to_string(config.steps) + " steps");
  return table;
}

}  // namespace mocaplm
