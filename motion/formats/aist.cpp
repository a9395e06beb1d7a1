#include "motion/formats/aist.h"

#include <map>
#include <regex>

namespace mocaplm {

std::optional<AistName> parse_aist_name(const std::string& stem) {
  static const std::map<std::string, std::string> genres = {
      {"BR", "break"},       {"PO", "pop"},        {"LO", "lock"},  {"MH", "middle-hip-hop"},
      {"LH", "la-hip-hop"},  {"HO", "house"},      {"WA", "waack"}, {"KR", "krump"},
      {"JS", "street-jazz"}, {"JB", "ballet-jazz"}};
  static const std::regex form(
      "(g([A-Z]{2})_s(BM|FM))_c(?:All|[0-9]{2})_((d[0-9]{2})_(m[A-Z]{2}[0-9])_(ch[0-9]{2}))"
      "(?:_(?:c(?:All|[0-9]{2})|(?:seg|slice)[_-]?[0-9]{1,9}))*");
  std::smatch parts;
  if (stem.size() > 120 || !std::regex_match(stem, parts, form)) return std::nullopt;
  const auto genre = genres.find(parts[2]);
  if (genre == genres.end()) return std::nullopt;
  return AistName{{{"genre", genre->second},
                   {"situation", parts[3] == "BM" ? "basic" : "advanced"},
                   {"dancer", parts[5]},
                   {"music", parts[6]},
                   {"choreography", parts[7]}},
                  parts[1].str() + "_cAll_" + parts[4].str()};
}

std::optional<Labels> aist_labels(const std::string& stem) {
  const std::optional<AistName> name = parse_aist_name(stem);
  if (!name) return std::nullopt;
  return name->labels;
}

}  // namespace mocaplm
