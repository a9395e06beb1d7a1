// What plots, charts and heat maps (viewer/plot.h, chart.h, heat_map.h) are written with. Letters
// are 12 units high; on a narrow page they grow to 16 (assets/plot.css), for which every picture
// leaves room.
#pragma once

#include <string>

namespace mocaplm::svg {

constexpr double kLetter = 9.6;  // the width of most letters at their largest, in units

// With two digits after the point at most.
std::string number(double value);

// <text>, escaped. `more`: further attributes.
std::string text(double x, double y, const std::string& anchor, const std::string& text,
                 const std::string& more = "");

// The beginning of a file: its name for assistive technology, a background, and the title on it.
// The end is "</svg>\n".
std::string open(double width, double height, const std::string& title);

// At most so many letters, the last one an ellipsis where some are left out.
std::string cut(const std::string& name, std::size_t letters);

// What `letters` of them need at most.
double width(std::size_t letters);

}  // namespace mocaplm::svg
