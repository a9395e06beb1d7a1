#include "viewer/page.h"

#include <algorithm>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"
#include "viewer/assets.h"
#include "viewer/figure.h"
#include "viewer/html.h"

namespace mocaplm {

namespace {

void check_page(const Page& page) {
  if (assets::three_js.empty())
    throw DataError(
        in_file("three.min.js"),
        "this program was built without three.js and cannot write pages; install libjs-three and "
        "configure the build again, or give -DMOCAPLM_THREE_JS=/path/to/three.min.js");
  if (page.motions.empty()) throw UsageError("a page needs at least one motion");
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
  json["points"] = base64(figure.points);
  return json;
}

std::string facts(const Clip& clip) {
  std::string text = format_fixed(clip.seconds(), 1) + " s, " + std::to_string(clip.frames()) +
                     " frames at " + format_number(clip.fps) + " fps";
  for (const auto& [name, value] : clip.labels) text += ", " + name + " " + value;
  return text;
}

std::string captions_html(const Page& page) {
  std::string out;
  for (const PageMotion& motion : page.motions) {
    out += "<li><h2>" + escape_html(motion.title) + "</h2>\n";
    if (!motion.caption.empty()) out += "<p>" + escape_html(motion.caption) + "</p>\n";
    out += "<p class=\"facts\">" + escape_html(facts(motion.clip)) + "</p>\n";
    if (!motion.highlighted_joints.empty())
      out += "<p class=\"facts given\">" + escape_html(page.highlight_name) + "</p>\n";
    out += "</li>\n";
  }
  return out;
}

std::string settings_html(const Page& page) {
  if (page.settings.empty()) return "";
  std::string out = "<section class=\"settings\"><h2>Settings</h2>\n<dl>\n";
  for (const auto& [name, value] : page.settings)
    out += "<div><dt>" + escape_html(name) + "</dt><dd>" + escape_html(value) + "</dd></div>\n";
  return out + "</dl></section>\n";
}

}  // namespace

std::string render_page(const Page& page) {
  check_page(page);
  Json motions = Json::array();
  for (const PageMotion& motion : page.motions) motions.push_back(motion_json(motion));
  std::string tables;
  for (const Table& table : page.tables) tables += html_table(table);
  return fill_template(
      assets::page_html,
      {{"title", escape_html(page.title)},
       {"note", page.note.empty() ? "" : "<p class=\"note\">" + escape_html(page.note) + "</p>"},
       {"captions", captions_html(page)},
       {"settings", settings_html(page)},
       {"tables", tables},
       {"style", std::string(assets::page_css)},
       {"three", std::string(assets::three_js)},
       {"data", script_json({{"motions", motions}})},
       {"script", std::string(assets::body_js) + std::string(assets::figure_js) +
                      std::string(assets::stage_js) + std::string(assets::page_js)}});
}

void write_page(const std::filesystem::path& path, const Page& page) {
  write_file(path, render_page(page));
}

}  // namespace mocaplm
