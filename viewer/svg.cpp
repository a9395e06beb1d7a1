#include "viewer/svg.h"

#include <cmath>

#include "common/text.h"
#include "viewer/html.h"

namespace mocaplm::svg {

std::string number(double value) {
  return format_number(std::round(value * 100) / 100);
}

std::string text(double x, double y, const std::string& anchor, const std::string& text,
                 const std::string& more) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" +
         (more.empty() ? "" : " " + more) + ">" + escape_html(text) + "</text>\n";
}

std::string open(double width, double height, const std::string& title) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " +
         number(height) +
         "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\" role=\"img\">\n<title>" +
         escape_html(title) +
         "</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         text(width / 2, 22, "middle", title, "class=\"title\" font-size=\"15\"");
}

std::string cut(const std::string& name, std::size_t letters) {
  if (name.size() <= letters) return name;
  std::size_t kept = letters - 1;
  // Not within a letter of several bytes (UTF-8).
  while (kept > 0 && (static_cast<unsigned char>(name[kept]) & 0xC0) == 0x80) --kept;
  return name.substr(0, kept) + "\u2026";
}

double width(std::size_t letters) {
  return kLetter * static_cast<double>(letters);
}

}  // namespace mocaplm::svg
