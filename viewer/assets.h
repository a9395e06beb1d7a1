// The files of viewer/assets/ and three.js, joined and embedded into the library when it is
// configured (viewer/CMakeLists.txt).
#pragma once

#include <string_view>

namespace mocaplm::assets {

extern const std::string_view page_html, stage_html, three_html;  // templates
extern const std::string_view page_css, stage_js, plot_js;        // several files each
// Debian's three.min.js; empty when it was not there at configure time.
extern const std::string_view three_js;

}  // namespace mocaplm::assets
