#include "spectral/index_layout.h"

#include "spectral/index.h"

namespace mocaplm {

Eigen::Index sketch_size(Eigen::Index d) {
  return d > 2 * kSketch ? kSketch : 0;
}

IndexLayout index_layout(const SpectralConfig& config, Eigen::Index raw, Eigen::Index n,
                         Eigen::Index d, Eigen::Index s) {
  IndexLayout layout;
  if (config.feature == "pca") {
    layout.time_frames = config.window;
    layout.time_components = config.coefficients;
  }
  if (config.reduce > 0) layout.reduce_from = raw;
  std::size_t at = kIndexRows;
  const auto floats = [&](Eigen::Index rows, Eigen::Index columns) {
    at += sizeof(float) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    return at;
  };
  layout.sketch = floats(n, d);
  layout.coarse = floats(n, s);
  layout.lengths = floats(n, s > 0 ? kCoarse : 0);
  layout.windows = floats(n, 1);
  layout.learned = floats(n, 2);
  floats(layout.time_frames, 1 + layout.time_components);
  floats(layout.reduce_from, config.reduce > 0 ? 1 + config.reduce : 0);
  layout.json = floats(s > 0 ? d : 0, s > 0 ? s - 1 : 0);
  return layout;
}

}  // namespace mocaplm
