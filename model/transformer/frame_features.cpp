#include "model/transformer/frame_features.h"

#include <cmath>

#include "common/angles.h"
#include "model/input.h"

namespace mocaplm {

namespace {

// Of each frame, what `x` (B, F, C) was `frames` frames before; 0 where that is before the window.
at::Tensor shifted(const at::Tensor& x, std::int64_t frames) {
  if (frames == 0) return x;
  const std::int64_t kept = std::max<std::int64_t>(x.size(1) - frames, 0);
  return at::constant_pad_nd(x.slice(1, 0, kept), {0, 0, x.size(1) - kept, 0});
}

// x[t] - x[t-1] from the frame `first` on, 0 before.
at::Tensor change(const at::Tensor& x, std::int64_t first) {
  at::Tensor out = at::zeros_like(x);
  if (x.size(1) > first) out.slice(1, first).copy_(x.slice(1, first) - x.slice(1, first - 1, -1));
  return out;
}

}  // namespace

at::Tensor frame_features(const at::Tensor& bin, std::int64_t bins) {
  const at::NoGradGuard no_grad;
  const at::Tensor shown = (bin >= 0).logical_and(bin < bins);
  const at::Tensor x = bin.to(at::kFloat);
  const at::Tensor u = (2 * x + 1) / static_cast<double>(bins) - 1;
  std::vector<at::Tensor> parts = {u};
  for (const double times : {1., 2., 4.}) {
    parts.push_back(at::sin(u * (times * kPi)));
    parts.push_back(at::cos(u * (times * kPi)));
  }
  const at::Tensor step = change(x, 1), turn = change(step, 2);
  parts.push_back(at::asinh(step) * 0.5);
  const at::Tensor wide = at::asinh(turn) * 0.5;
  parts.push_back(wide);
  parts.push_back(shifted(wide, 1));
  const at::Tensor fine = turn.clamp(-kMostChange, kMostChange) * 0.25;
  for (std::int64_t lag = 0; lag < kFrameLags; ++lag) parts.push_back(shifted(fine, lag));
  return (at::stack(parts, 3) * shown.unsqueeze(3)).flatten(2);
}

}  // namespace mocaplm
