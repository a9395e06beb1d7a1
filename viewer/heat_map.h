// Pictures of matrices as an SVG file of its own: panels side by side on one scale of colours.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mocaplm {

struct HeatMap {
  std::string title;
  Eigen::MatrixXd values;         // row 0 is drawn at the bottom, column 0 at the left
  double x_high = 1, y_high = 1;  // what the right and the upper edge stand for; the others are 0
};

// Colours from viridis, dark for the least value of all panels, bright for the greatest.
// Neighbouring columns are averaged where there are more than 400. Values that are not finite are
// left out. Throws UsageError when there is no value.
std::string heat_maps_svg(const std::string& title, const std::string& x_label,
                          const std::string& y_label, const std::vector<HeatMap>& panels);

}  // namespace mocaplm
