#include <algorithm>

#include "common/error.h"
#include "common/text.h"
#include "motion/synth/vocabulary.h"

namespace mocaplm {

namespace {

std::vector<Genre> make_genres() {
  std::vector<Genre> all;
  // Columns: code, name, first dancer, bend, attack, drive, freeze, turning.
  all.push_back({"BR",
                 "break",
                 4,
                 0.05,
                 0.20,
                 1.0,
                 0.10,
                 0.40,
                 {{"guard", 3}, {"cross", 2}, {"hit-down", 1}, {"swing", 1}, {"jab", 1}},
                 {{"rock", 2}, {"bounce", 2}, {"twist", 2}, {"sway", 1}},
                 {{"toprock", 4}, {"kick", 2}, {"pivot", 2}, {"shuffle", 1}}});
  all.push_back({"PO",
                 "pop",
                 10,
                 0.04,
                 0.15,
                 0.9,
                 0.25,
                 0.20,
                 {{"robot", 3}, {"wave", 2}, {"chest-arms", 2}, {"swing", 1}, {"point", 1}},
                 {{"pop", 4}, {"roll", 1}, {"twist", 1}},
                 {{"plant", 3}, {"step-touch", 2}, {"march", 1}, {"pivot", 1}}});
  all.push_back({"LO",
                 "lock",
                 13,
                 0.04,
                 0.18,
                 1.0,
                 0.45,
                 0.25,
                 {{"point", 3}, {"twirl", 3}, {"robot", 1}, {"circle", 1}, {"jab", 1}},
                 {{"bounce", 2}, {"rock", 2}, {"pop", 1}, {"sway", 1}},
                 {{"step-touch", 2}, {"kick", 2}, {"plant", 2}, {"rock-step", 1}}});
  all.push_back({"MH",
                 "middle hip-hop",
                 22,
                 0.05,
                 0.24,
                 1.1,
                 0.10,
                 0.30,
                 {{"swing", 2}, {"jab", 2}, {"wave", 2}, {"cross", 2}, {"guard", 1}},
                 {{"bounce", 3}, {"rock", 2}, {"roll", 2}},
                 {{"rock-step", 2}, {"step-touch", 2}, {"march", 2}, {"cross-step", 1}}});
  all.push_back({"LH",
                 "LA-style hip-hop",
                 16,
                 0.04,
                 0.19,
                 1.0,
                 0.20,
                 0.35,
                 {{"jab", 2}, {"point", 2}, {"wave", 2}, {"hit-down", 2}, {"frame", 2}},
                 {{"pop", 2}, {"roll", 2}, {"bounce", 1}, {"twist", 1}},
                 {{"lunge", 2}, {"plant", 2}, {"pivot", 2}, {"step-touch", 1}}});
  all.push_back({"HO",
                 "house",
                 19,
                 0.08,
                 0.26,
                 1.0,
                 0.03,
                 0.30,
                 {{"swing", 3}, {"cross", 2}, {"low-circle", 2}, {"guard", 2}},
                 {{"rock", 3}, {"bounce", 1}, {"sway", 1}, {"twist", 1}},
                 {{"shuffle", 4}, {"cross-step", 3}, {"toprock", 1}, {"kick", 1}}});
  all.push_back({"WA",
                 "waack",
                 25,
                 0.03,
                 0.20,
                 0.8,
                 0.15,
                 0.35,
                 {{"circle", 4}, {"overhead", 3}, {"twirl", 2}, {"port-de-bras", 1}},
                 {{"sway", 2}, {"twist", 2}, {"bounce", 1}, {"long", 1}},
                 {{"step-touch", 3}, {"pivot", 2}, {"plant", 1}, {"cross-step", 1}}});
  all.push_back({"KR",
                 "krump",
                 28,
                 0.12,
                 0.16,
                 1.4,
                 0.08,
                 0.25,
                 {{"hit-down", 4}, {"chest-arms", 2}, {"jab", 3}, {"swing", 1}},
                 {{"pop", 3}, {"bounce", 2}, {"roll", 1}},
                 {{"stomp", 4}, {"plant", 2}, {"lunge", 1}, {"march", 1}}});
  all.push_back({"JS",
                 "street jazz",
                 1,
                 0.03,
                 0.21,
                 1.0,
                 0.20,
                 0.45,
                 {{"frame", 2}, {"overhead", 2}, {"long-line", 2}, {"cross", 2}, {"hit-down", 1}},
                 {{"roll", 2}, {"sway", 2}, {"twist", 2}, {"pop", 1}},
                 {{"lunge", 2}, {"cross-step", 2}, {"pivot", 2}, {"kick", 1}}});
  all.push_back({"JB",
                 "ballet jazz",
                 7,
                 0.02,
                 0.32,
                 0.9,
                 0.10,
                 0.50,
                 {{"long-line", 4}, {"port-de-bras", 4}, {"low-circle", 1}, {"cross", 1}},
                 {{"long", 4}, {"sway", 1}, {"roll", 1}},
                 {{"lunge", 2}, {"pivot", 3}, {"kick", 2}, {"cross-step", 2}}});
  return all;
}

}  // namespace

const std::vector<Genre>& genres() {
  static const std::vector<Genre> all = make_genres();
  return all;
}

const Genre& genre_by_code(const std::string& code) {
  std::vector<std::string> codes;
  for (const Genre& genre : genres()) {
    if (genre.code == code) return genre;
    codes.push_back(genre.code);
  }
  throw UsageError("no genre \"" + code + "\"" + did_you_mean(code, codes) +
                   " (known: " + join(codes, ", ") + ")");
}

}  // namespace mocaplm
