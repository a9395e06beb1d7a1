#include "spectral/interpolate/interpolate.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "common/error.h"
#include "common/random.h"
#include "common/text.h"
#include "motion/resample.h"
#include "numeric/components.h"
#include "numeric/dct.h"
#include "numeric/stft.h"
#include "spectral/frequencies.h"
#include "spectral/measures.h"
#include "spectral/unwound.h"

namespace mocaplm {

namespace {

constexpr double kLeastMagnitude = 1e-12;  // squared: the root's slope at 0 has no end
// Radians added to the courses whose components are sought: joints that never move would have
// components of the same strength, 0, which have no slope.
constexpr double kDither = 1e-9;
// Of a step's rate once a step has lowered the loss, up to the rate asked for.
constexpr double kRecovery = 1.2;
using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
using TensorFunction = std::function<torch::Tensor(const torch::Tensor&)>;  // of x (T, 72)

torch::Tensor tensor_of(const Eigen::Ref<const RowMajor>& matrix) {
  const RowMajor plain = matrix;
  return torch::from_blob(const_cast<double*>(plain.data()), {plain.rows(), plain.cols()},
                          torch::kFloat64)
      .clone();
}

RowRange rows_in_range(double step, Eigen::Index rows, const InterpolateConfig& config) {
  const RowRange range = rows_within(config.from_hz, config.to_hz, step, rows);
  if (range.count() <= 0)
    throw UsageError("no frequency of the " + config.target + " lies from from_hz " +
                     format_number(config.from_hz) + " to to_hz " + format_number(config.to_hz) +
                     ": it has multiples of " + format_fixed(step, 3) + " Hz");
  return range;
}

TensorFunction dct_function(Eigen::Index frames, const InterpolateConfig& config) {
  const RowRange range = rows_in_range(dct_step(config.fps, frames), frames, config);
  const torch::Tensor basis = tensor_of(dct_rows(frames, range.first, range.count()));
  return [basis](const torch::Tensor& x) { return basis.matmul(x); };
}

TensorFunction stft_function(const InterpolateConfig& config) {
  const Eigen::Index n = config.stft_window, bins = stft_bins(n), hop = config.hop();
  const RowRange range = rows_in_range(config.fps / static_cast<double>(n), bins, config);
  const Eigen::Index count = range.count();
  Eigen::MatrixXd basis(2 * count, n);
  const Eigen::MatrixXd all = stft_basis(n);
  basis << all.middleRows(range.first, count), all.middleRows(bins + range.first, count);
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

void check_coefficients(const InterpolateConfig& config, Eigen::Index most, const char* what) {
  if (config.coefficients > most)
    throw UsageError("coefficients is " + std::to_string(config.coefficients) +
                     ", more than the motions' " + std::to_string(most) + " " + what);
}

TensorFunction pca_function(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  check_coefficients(config, a.frames(), "frames");
  Eigen::MatrixXd courses(144, a.frames());
  courses << a.poses.transpose(), b.poses.transpose();
  const Components components = principal_components(courses, config.coefficients);
  const torch::Tensor basis = tensor_of(components.synthesis);
  const torch::Tensor mean = tensor_of(components.mean.transpose());
  return [basis, mean](const torch::Tensor& x) { return basis.matmul(x - mean); };
}

// The courses are the samples, time the dimensions: courses = U S V', and U S are their scores.
TensorFunction own_pca_function(const Clip& a, const InterpolateConfig& config) {
  check_coefficients(config, a.frames(), "frames");
  check_coefficients(config, a.poses.cols(), "courses");
  Random random(1);
  RowMajor noise(a.poses.cols(), a.frames());
  for (Eigen::Index i = 0; i < noise.size(); ++i) noise.data()[i] = kDither * random.normal();
  const torch::Tensor dither = tensor_of(noise);
  const std::int64_t count = config.coefficients;
  const auto parts = [dither, count](const torch::Tensor& x) {
    const torch::Tensor courses = x.t() + dither;
    const auto [u, s, vh] = at::linalg_svd(courses - courses.mean(0, true), false);
    return std::make_pair(u.narrow(1, 0, count) * s.narrow(0, 0, count), vh.narrow(0, 0, count));
  };
  const torch::Tensor reference = parts(tensor_of(a.poses)).second;
  return [parts, reference](const torch::Tensor& x) {
    const auto [scores, components] = parts(x);
    return scores * (components.detach() * reference).sum(1).sign();
  };
}

TensorFunction feature_function(const Clip& a, const Clip& b, const InterpolateConfig& config) {
  if (config.target == "dct") return dct_function(a.frames(), config);
  if (config.target == "pca") return pca_function(a, b, config);
  if (config.target == "own_pca") return own_pca_function(a, config);
  if (a.frames() < config.stft_window)
    throw DataError(in_file(a.name), "the motions have " + std::to_string(a.frames()) +
                                         " frames in common, fewer than a Hann window of " +
                                         std::to_string(config.stft_window));
  return stft_function(config);
}

// Gradient descent from x; a step that does not lower the loss is taken back, the next is shorter.
torch::Tensor descend(const torch::Tensor& x, const TensorFunction& loss,
                      const InterpolateConfig& config) {
  torch::Tensor at = x.detach().requires_grad_(true);
  torch::Tensor value = loss(at);
  value.backward();
  double rate = config.rate;
  for (std::int64_t step = 0; step < config.steps; ++step) {
    torch::Tensor next = (at.detach() - 0.5 * rate * at.grad()).requires_grad_(true);
    const torch::Tensor changed = loss(next);
    if (!(changed.item<double>() <= value.item<double>())) {  // or it is no number
      rate /= 2;
      continue;
    }
    changed.backward();
    at = next;
    value = changed;
    rate = std::min(config.rate, kRecovery * rate);
  }
  if (!at.grad().isfinite().all().item<bool>())
    throw UsageError("the descent by " + config.target +
                     " came where the features have no slope: give fewer --steps or another "
                     "--target");
  return at.detach().contiguous();
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
    return stft_magnitudes<double>(RowMajor(clip.poses), stft_basis(config.stft_window),
                                   config.hop());
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool long_enough = result.original.frames() >= config.stft_window;
  result.stft = long_enough ? similarities(result, stft) : Similarities{kNone, kNone, kNone};
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

  const TensorFunction f = feature_function(result.original, result.target, config);
  const torch::Tensor start = tensor_of(result.original.poses);
  const torch::Tensor from = f(start), to = f(tensor_of(result.target.poses));
  const auto error = [&](const torch::Tensor& features) {
    return (features - to).square().mean().item<double>();
  };
  const auto loss = [&](const torch::Tensor& at) {
    const torch::Tensor features = f(at);
    return config.weight * (features - to).square().sum() +
           (1 - config.weight) * (features - from).square().sum();
  };
  const torch::Tensor x = descend(start, loss, config);
  result.features = from.numel();
  result.error_before = error(from);
  result.error_after = error(f(x));
  result.result = result.original;
  result.result.name = result.original.name + " towards " + result.target.name;
  result.result.poses = Eigen::Map<const Poses>(x.data_ptr<double>(), frames, 72);
  compare(result, config);
  result.result = wound(result.result);
  return result;
}

Table interpolate_table(const InterpolateResult& result, const InterpolateConfig& config) {
  Table table(result.original.name + " towards " + result.target.name + ", by " + config.target,
              {"motion", "roughness m/s^3", "above 8 Hz %", "STFT cosine to O", "to T",
               "DCT cosine to O", "DCT to T"});
  table.digits({-1, 2, 3, 3, 3, 3, 3});
  const auto cell = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
  const auto row = [&](const char* name, const Clip& clip, double so, double st, double d_o,
                       double dt) {
    table.row({name, roughness(clip), 100 * fast_share(clip), cell(so), cell(st), d_o, dt});
  };
  const Similarities &s = result.stft, &d = result.dct;
  row("original (O)", result.original, 1, s.original_target, 1, d.original_target);
  row("target (T)", result.target, s.original_target, 1, d.original_target, 1);
  row("interpolated (I)", result.result, s.result_original, s.result_target, d.result_original,
      d.result_target);
  if (std::isfinite(s.original_target))
    table.note("STFT cosines (Table 3.3): O-T " + format_fixed(s.original_target, 3) + ", I-O " +
               format_fixed(s.result_original, 3) + ", I-T " + format_fixed(s.result_target, 3));
  table.note("mean squared error of " + std::to_string(result.features) + " features: " +
             format_number(result.error_before) + " before, " + format_number(result.error_after) +
             " after " + std::to_string(config.steps) + " steps");
  return table;
}

}  // namespace mocaplm
