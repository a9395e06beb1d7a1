#include "viewer/html.h"

#include <cctype>

#include "common/error.h"

namespace mocaplm {

namespace {

std::string escape_character(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      break;
  }
  const auto byte = static_cast<unsigned char>(c);
  const bool control = (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F;
  return control ? "" : std::string(1, c);
}

// Longer ones are broken into lines.
constexpr std::size_t kLongCell = 40;

bool like_a_number(const std::string& text) {
  const std::size_t at = text.find_first_not_of("+-.<>~ ");
  return at == std::string::npos || std::isdigit(static_cast<unsigned char>(text[at])) != 0 ||
         text == "nan" || text == "inf" || text == "-inf";
}

// Of each column whether it is text, with the first one always so.
std::vector<bool> text_columns(const Table& table) {
  std::vector<bool> found(table.columns().size(), false);
  for (const auto& cells : table.rows())
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (cells[c].is_string() && !like_a_number(cells[c].get<std::string>())) found[c] = true;
  if (!found.empty()) found[0] = true;
  return found;
}

std::string cell_class(bool text, std::size_t letters) {
  if (!text && letters <= kLongCell) return "";
  return std::string(" class=\"") + (text ? "text" : "") + (letters > kLongCell ? " long" : "") +
         "\"";
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) out += escape_character(c);
  return out;
}

std::string escape_name(std::string_view text) {
  std::string out;
  for (const char c : text) {
    out += escape_character(c);
    if (c == '_' || c == '/') out += "<wbr>";
  }
  return out;
}

std::string script_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else if (c == '>') {
      out += "\\u003e";
    } else {
      out += c;
    }
  }
  return out;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) -> std::uint32_t { return i < bytes.size() ? bytes[i] : 0; };
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (std::size_t k = 0; k < 4; ++k)
      out += k > bytes.size() - i ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return out;
}

std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values) {
  std::string out;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find("{{", at);
    if (open == std::string_view::npos) return out.append(text.substr(at));
    const std::size_t close = text.find("}}", open);
    const std::string name(
        text.substr(open + 2, close == std::string_view::npos ? 0 : close - open - 2));
    const auto value = values.find(name);
    if (value == values.end())
      throw Error(ExitCode::internal,
                  "the page's template names an unknown value \"" + name + "\"");
    out.append(text.substr(at, open - at)).append(value->second);
    at = close + 2;
  }
}

std::string html_table(const Table& table) {
  const std::string title = escape_html(table.title());
  std::string out = "<figure class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"" + title +
                    "\">\n<table>\n";
  if (!title.empty()) out += "<caption>" + title + "</caption>\n";
  out += "<thead><tr>";
  const std::vector<bool> is_text = text_columns(table);
  for (std::size_t c = 0; c < table.columns().size(); ++c)
    out += "<th scope=\"col\"" + cell_class(is_text[c], 0) + ">" + escape_html(table.columns()[c]) +
           "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& cells : table.rows()) {
    out += "<tr>";
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string text = table.cell(c, cells[c]), tag = c == 0 ? "th" : "td";
      out += "<" + tag + (c == 0 ? " scope=\"row\"" : "") + cell_class(is_text[c], text.size()) +
             ">" + escape_html(text) + "</" + tag + ">";
    }
    out += "</tr>\n";
  }
  out += "</tbody>\n</table>\n";
  for (const std::string& note : table.notes()) out += "<p>" + escape_html(note) + "</p>\n";
  return out + "</figure>\n";
}

}  // namespace mocaplm
