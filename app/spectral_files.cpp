#include "app/spectral_files.h"

#include <algorithm>
#include <filesystem>

#include "app/generated.h"
#include "common/files.h"
#include "motion/formats/formats.h"
#include "spectral/embedding.h"
#include "viewer/heat_map.h"
#include "viewer/plot.h"

namespace mocaplm {

namespace {

constexpr Eigen::Index kMostPoints = 400;  // of a line in the picture of DCT coefficients

std::vector<Series> series_of(const NamedClips& clips) {
  std::vector<Series> all;
  for (const auto& [name, clip] : clips) all.push_back(whole_series(clip));
  return all;
}

// Thesis Figure 3.4.
std::string spectrograms(const NamedClips& clips, std::int64_t window, std::int64_t hop) {
  const std::vector<Eigen::MatrixXd> pictures = stft_embeddings(series_of(clips), window, hop);
  double low = pictures[0].minCoeff(), high = pictures[0].maxCoeff();
  for (const Eigen::MatrixXd& picture : pictures) {
    low = std::min(low, picture.minCoeff());
    high = std::max(high, picture.maxCoeff());
  }
  // Low frequencies have most of the energy: three powers of ten below the most are shown.
  const double unit = 1e-3 * std::max(high - low, 1e-12);
  std::vector<HeatMap> panels;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const double fps = clips[i].second.fps;
    const Eigen::MatrixXd shown = ((pictures[i].array() - low) / unit + 1).log10();
    panels.push_back(
        {clips[i].first, shown, static_cast<double>(pictures[i].cols() * hop) / fps, fps / 2});
  }
  return heat_maps_svg("first principal component of the STFT magnitudes, logarithm", "seconds",
                       "Hz", panels);
}

// Thesis Figures 3.3 and 3.5.
std::string coefficients(const NamedClips& clips) {
  const std::vector<Eigen::VectorXd> lines = dct_embeddings(series_of(clips));
  Plot plot{"first principal component of the DCT coefficients' magnitudes",
            "Hz",
            "first component, rad",
            false,
            false,
            {}};
  for (std::size_t i = 0; i < clips.size(); ++i) {
    PlotSeries line{clips[i].first, {}, true};
    const double step = clips[i].second.fps / (2 * static_cast<double>(lines[i].size()));
    // Without the mean (k = 0), which would leave no room for the others.
    for (Eigen::Index k = 1; k < std::min(kMostPoints, lines[i].size()); ++k)
      line.points.push_back({step * static_cast<double>(k), lines[i][k], ""});
    plot.series.push_back(line);
  }
  return plot_svg(plot);
}

}  // namespace

void SpectralFiles::check(const std::vector<std::string>& inputs) const {
  std::vector<std::string> files = generated_files(out);
  files.insert(files.end(), {plot, spectrogram, json});
  check_outputs(std::vector<std::filesystem::path>(files.begin(), files.end()),
                std::vector<std::filesystem::path>(inputs.begin(), inputs.end()));
  for (const std::string& file : files) check_writable(file);
}

std::vector<std::string> SpectralFiles::write(const Clip& result, const Page& page,
                                              const NamedClips& clips, std::int64_t stft_window,
                                              std::int64_t hop) const {
  // The pictures first: a motion may be too short for one, and then nothing is written.
  std::vector<std::pair<std::string, std::string>> pictures;
  if (!plot.empty()) pictures.emplace_back(plot, coefficients(clips));
  if (!spectrogram.empty())
    pictures.emplace_back(spectrogram, spectrograms(clips, stft_window, hop));
  std::vector<std::string> files = generated_files(out);
  for (const std::string& file : files)
    std::filesystem::path(file).extension() == ".html" ? write_page(file, page)
                                                       : write_clip(file, result);
  for (const auto& [file, picture] : pictures) {
    write_file(file, picture);
    files.push_back(file);
  }
  return files;
}

}  // namespace mocaplm
