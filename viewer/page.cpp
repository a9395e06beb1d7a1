#include "viewer/page.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "viewer/assets.h"
#include "viewer/figure.h"
#include "viewer/html.h"
#include "viewer/pack.h"

namespace mocaplm {

namespace {

void check_page(const Page& page) {
  if (page.motions.empty() && page.plots.empty() && page.tables.empty())
    throw UsageError("a page needs a motion, a plot or a table");
  if (!page.motions.empty() && assets::three_js.empty())
    throw DataError(
        in_file("three.min.js"),
        "this program was built without three.js and cannot write pages with figures; install "
        "libjs-three (scripts/install does) and configure the build again, or give "
        "-DMOCAPLM_THREE_JS=/path/to/three.min.js");
  for (const PageMotion& motion : page.motions)
    for (const auto* joints : {&motion.highlighted_joints, &motion.trails})
      for (const int joint : *joints)
        if (joint < 0 || joint >= kJoints)
          throw UsageError("motion \"" + motion.title + "\": there is no joint " +
                           std::to_string(joint) + ", expected 0 to " +
                           std::to_string(kJoints - 1));
}

Json motion_json(const PageMotion& motion) {
  const Figure figure = make_figure(motion.clip);
  Json json = {{"title", motion.title},   {"fps", figure.fps},
               {"frames", figure.frames}, {"every", figure.every},
               {"unit", figure.unit},     {"highlighted", motion.highlighted_joints},
               {"trails", motion.trails}};
  json["points"] = pack_points(figure.points, 3 * kFigurePoints);
  return json;
}

std::string facts(const Clip& clip) {
  std::string text = format_fixed(clip.seconds(), 1) + " s, " + std::to_string(clip.frames()) +
                     " frames at " + format_number(clip.fps) + " fps";
  for (const auto& [name, value] : clip.labels) text += ", " + name + " " + value;
  return text;
}

std::string captions_html(const Page& page) {
  if (page.motions.empty()) return "";
  std::string out = "<section aria-label=\"Motions\">\n<ul id=\"captions\">\n";
  for (const PageMotion& motion : page.motions) {
    out += "<li><h2>" + escape_name(motion.title) + "</h2>\n";
    if (!motion.caption.empty()) out += "<p>" + escape_name(motion.caption) + "</p>\n";
    out += "<p class=\"facts\">" + escape_name(facts(motion.clip)) + "</p>\n";
    if (!motion.highlighted_joints.empty())
      out += "<p class=\"facts given\">" + escape_html(page.highlight_name) + "</p>\n";
    out += "</li>\n";
  }
  return out + "</ul>\n</section>\n";
}

// Longer values take two places.
constexpr std::size_t kLongSetting = 24;
// A few settings stand under the figures, more of them at the page's end.
constexpr std::size_t kFewSettings = 10;

std::string settings_html(const Page& page) {
  if (page.settings.empty()) return "";
  std::string out = "<section class=\"settings\"><h2>Settings</h2>\n<dl>\n";
  for (const auto& [name, value] : page.settings)
    out += std::string(value.size() > kLongSetting ? "<div class=\"long\">" : "<div>") + "<dt>" +
           escape_name(name) + "</dt><dd>" + escape_name(value) + "</dd></div>\n";
  return out + "</dl></section>\n";
}

std::string setting_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return format_number(value.get<double>());
  if (!value.is_array()) return value.is_null() ? "\u2013" : value.dump();
  std::vector<std::string> parts;
  for (const Json& one : value) parts.push_back(setting_text(one));
  return parts.empty() ? "\u2013" : join(parts, ", ");
}

std::string plots_html(const Page& page) {
  std::string out;
  for (const PagePlot& plot : page.plots)
    out += "<section class=\"plot\">\n<div class=\"picture\">" + plot.svg + "</div>\n" +
           html_table(plot.numbers) + "</section>\n";
  return out;
}

std::string tables_html(const Page& page) {
  std::string out;
  for (const Table& table : page.tables) out += html_table(table);
  return out.empty() ? "" : "<section aria-label=\"Tables\">\n" + out + "</section>\n";
}

std::string script_tag(std::string_view script) {
  return "<script>\n" + std::string(script) + "</script>\n";
}

// The data, three.js and the player; where nothing moves, none of them.
std::string scripts_html(const Page& page) {
  std::string out;
  if (!page.motions.empty()) {
    Json motions = Json::array();
    for (const PageMotion& motion : page.motions) motions.push_back(motion_json(motion));
    const Json data = {{"motions", motions}, {"joints", joint_names()}};
    out += "<script type=\"application/json\" id=\"data\">" + script_json(data) + "</script>\n";
    out += fill_template(assets::three_html, {{"three", std::string(assets::three_js)}});
    out += script_tag(assets::stage_js);
  }
  if (!page.plots.empty()) out += script_tag(assets::plot_js);
  return out;
}

}  // namespace

void add_settings(Page& page, const Json& json) {
  for (const auto& [name, value] : json.items()) {
    if (value.is_object())
      add_settings(page, value);
    else
      page.settings.emplace_back(name, setting_text(value));
  }
}

std::string render_page(const Page& page) {
  check_page(page);
  const bool moves = !page.motions.empty(), few = page.settings.size() <= kFewSettings;
  return fill_template(
      assets::page_html,
      {{"title", escape_html(page.title)},
       {"note", page.note.empty() ? "" : "<p class=\"note\">" + escape_html(page.note) + "</p>"},
       {"style", std::string(assets::page_css)},
       {"stage", moves ? std::string(assets::stage_html) : ""},
       {"captions", captions_html(page)},
       {"few_settings", few ? settings_html(page) : ""},
       {"many_settings", few ? "" : settings_html(page)},
       {"plots", plots_html(page)},
       {"tables", tables_html(page)},
       {"credit", moves ? " Drawn with three.js, MIT licence, included in this file." : ""},
       {"scripts", scripts_html(page)}});
}

void write_page(const std::filesystem::path& path, const Page& page) {
  write_file(path, render_page(page));
}

}  // namespace mocaplm
