#include "spectral/config.h"

#include "common/error.h"
#include "motion/skeleton.h"

namespace mocaplm {

void check_config(const SpectralConfig& config) {
  const std::string window = "the window's " + std::to_string(config.window) + " frames";
  if (config.feature == "stft" && config.stft_window > config.window)
    throw UsageError("stft_window is " + std::to_string(config.stft_window) + ", more than " +
                     window);
  if ((config.feature == "dct" || config.feature == "pca") && config.coefficients > config.window)
    throw UsageError("coefficients is " + std::to_string(config.coefficients) + ", more than " +
                     window);
  parse_joints(config.joints);
}

}  // namespace mocaplm
