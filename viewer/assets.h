// The text files of viewer/assets/ and three.js, embedded into the library when it is configured.
#pragma once

#include <string_view>

namespace mocaplm::assets {

extern const std::string_view page_html, page_css, body_js, figure_js, stage_js, page_js;
// Debian's three.min.js; empty when it was not there at configure time.
extern const std::string_view three_js;

}  // namespace mocaplm::assets
