#include "motion/formats/joint_words.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "common/text.h"

namespace mocaplm {

namespace {

bool is_upper(char c) {
  return std::isupper(static_cast<unsigned char>(c)) != 0;
}
bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

// "mixamorig:LeftUpLeg" -> {"mixamorig", "left", "up", "leg"}: at other signs, at digits, before a
// capital that follows a small letter or goes before one.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool capital = is_upper(c);
    const bool before_small =
        i + 1 < name.size() && std::islower(static_cast<unsigned char>(name[i + 1]));
    const bool after_small = i > 0 && std::islower(static_cast<unsigned char>(name[i - 1]));
    if (!is_letter(c) || (capital && (after_small || before_small)))
      if (!words.back().empty()) words.emplace_back();
    if (is_letter(c))
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

Side side_of_word(const std::string& word) {
  static const std::map<std::string, Side> words = {
      {"l", Side::left},       {"left", Side::left},    {"lft", Side::left},
      {"lt", Side::left},      {"lf", Side::left},      {"r", Side::right},
      {"right", Side::right},  {"rgt", Side::right},    {"rt", Side::right},
      {"links", Side::left},   {"rechts", Side::right}, {"gauche", Side::left},
      {"droite", Side::right}, {"izq", Side::left},     {"der", Side::right}};
  const auto found = words.find(word);
  return found == words.end() ? Side::none : found->second;
}

struct Vocabulary {
  const char* word;
  Part part;
};

// The first that the bare name holds decides, so longer and surer words stand first.
const std::vector<Vocabulary>& vocabulary() {
  static const std::vector<Vocabulary> all = {// Necks and heads that are called a twist are none.
                                              {"necktwist", Part::neck},
                                              {"twist", Part::helper},
                                              {"roll", Part::helper},
                                              {"sharebone", Part::helper},
                                              {"helper", Part::helper},
                                              {"target", Part::helper},
                                              {"pole", Part::helper},
                                              {"effector", Part::helper},
                                              {"ctrl", Part::helper},
                                              {"control", Part::helper},
                                              {"nub", Part::helper},
                                              {"skirt", Part::helper},
                                              {"hair", Part::helper},
                                              {"cloth", Part::helper},
                                              {"cape", Part::helper},
                                              {"weapon", Part::helper},
                                              {"sword", Part::helper},
                                              {"prop", Part::helper},
                                              {"socket", Part::helper},
                                              {"attach", Part::helper},
                                              {"camera", Part::helper},
                                              {"breast", Part::helper},
                                              {"bust", Part::helper},
                                              {"pectoral", Part::helper},
                                              {"boob", Part::helper},
                                              {"eye", Part::helper},
                                              {"ear", Part::helper},
                                              {"jaw", Part::helper},
                                              {"tongue", Part::helper},
                                              {"teeth", Part::helper},
                                              {"lip", Part::helper},
                                              {"nose", Part::helper},
                                              {"brow", Part::helper},
                                              {"cheek", Part::helper},
                                              {"facial", Part::helper},
                                              {"mouth", Part::helper},
                                              {"tail", Part::helper},
                                              {"wing", Part::helper},
                                              {"thumb", Part::finger},
                                              {"index", Part::finger},
                                              {"middle", Part::finger},
                                              {"pinky", Part::finger},
                                              {"pinkie", Part::finger},
                                              {"ringtoe", Part::toe},
                                              {"midtoe", Part::toe},
                                              {"ring", Part::finger},
                                              {"little", Part::finger},
                                              {"finger", Part::finger},
                                              {"mid", Part::finger},
                                              {"metacarp", Part::finger},
                                              {"carpal", Part::finger},
                                              {"knuckle", Part::finger},
                                              {"toe", Part::toe},
                                              {"ball", Part::toe},
                                              {"metatars", Part::toe},
                                              {"upperleg", Part::thigh},
                                              {"upleg", Part::thigh},
                                              {"legup", Part::thigh},
                                              {"thigh", Part::thigh},
                                              {"femur", Part::thigh},
                                              {"lowerleg", Part::shin},
                                              {"lowleg", Part::shin},
                                              {"legdown", Part::shin},
                                              {"leglow", Part::shin},
                                              {"knee", Part::shin},
                                              {"shin", Part::shin},
                                              {"calf", Part::shin},
                                              {"tibia", Part::shin},
                                              {"crus", Part::shin},
                                              {"shank", Part::shin},
                                              {"foot", Part::foot_or_ankle},
                                              {"ankle", Part::foot_or_ankle},
                                              {"talus", Part::foot_or_ankle},
                                              {"heel", Part::helper},
                                              {"buttock", Part::helper},
                                              {"hipjoint", Part::helper},
                                              {"forearm", Part::forearm},
                                              {"lowerarm", Part::forearm},
                                              {"lowarm", Part::forearm},
                                              {"armlow", Part::forearm},
                                              {"armdown", Part::forearm},
                                              {"elbow", Part::forearm},
                                              {"radius", Part::forearm},
                                              {"ulna", Part::forearm},
                                              {"upperarm", Part::upper_arm},
                                              {"uparm", Part::upper_arm},
                                              {"armup", Part::upper_arm},
                                              {"humerus", Part::upper_arm},
                                              {"shldr", Part::upper_arm},
                                              {"bicep", Part::upper_arm},
                                              {"clavicle", Part::collar},
                                              {"clav", Part::collar},
                                              {"collar", Part::collar},
                                              {"scapula", Part::collar},
                                              {"shoulder", Part::shoulder_or_collar},
                                              {"hand", Part::hand},
                                              {"wrist", Part::hand},
                                              {"palm", Part::hand},
                                              {"arm", Part::arm},
                                              {"pelvis", Part::pelvis},
                                              {"hips", Part::pelvis},
                                              {"hip", Part::hip},
                                              {"leg", Part::leg},
                                              {"spine", Part::spine},
                                              {"chest", Part::spine},
                                              {"abdomen", Part::spine},
                                              {"torso", Part::spine},
                                              {"waist", Part::spine},
                                              {"thorax", Part::spine},
                                              {"lowerback", Part::spine},
                                              {"upperback", Part::spine},
                                              {"back", Part::spine},
                                              {"rib", Part::spine},
                                              {"stomach", Part::spine},
                                              {"belly", Part::spine},
                                              {"lumbar", Part::spine},
                                              {"trunk", Part::spine},
                                              {"neck", Part::neck},
                                              {"cervical", Part::neck},
                                              {"head", Part::head},
                                              {"skull", Part::head},
                                              {"face", Part::head},
                                              {"root", Part::pelvis},
                                              {"center", Part::pelvis},
                                              {"centre", Part::pelvis},
                                              {"fore", Part::forearm},
                                              {"cog", Part::pelvis}};
  return all;
}

Part part_of(const std::string& bare) {
  // A short word that others hold by chance ("ear" in "forearm", "rib" in "tribal") must be one.
  static const std::vector<std::string> whole = {"ear",  "lip",  "rib",  "cog",  "eye",  "ring",
                                                 "mid",  "prop", "roll", "pole", "cape", "fore",
                                                 "tail", "wing", "root", "clav"};
  for (const Vocabulary& entry : vocabulary()) {
    const std::size_t at = bare.find(entry.word);
    if (at == bare.npos) continue;
    const std::string word = entry.word;
    const bool must_be_whole = std::find(whole.begin(), whole.end(), word) != whole.end();
    if (must_be_whole && at != 0 && at + word.size() != bare.size()) continue;
    if (word == "ear" && bare != "ear" && bare != "ears") continue;
    return entry.part;
  }
  return Part::unknown;
}

// The side that stands glued to a word that is known without it: "lthigh", "rightupleg", "thighr".
Side glued_side(std::string& bare) {
  for (const auto& [text, side] :
       std::vector<std::pair<std::string, Side>>{{"left", Side::left}, {"right", Side::right}}) {
    const std::size_t at = bare.find(text);
    if (at == bare.npos) continue;
    bare.erase(at, text.size());
    return side;
  }
  if (bare.size() < 4) return Side::none;
  const auto begins = [&](const std::string& rest) {
    return std::any_of(vocabulary().begin(), vocabulary().end(), [&](const Vocabulary& v) {
      return v.part > Part::head && rest.compare(0, std::string(v.word).size(), v.word) == 0;
    });
  };
  const char first = bare.front(), last = bare.back();
  if ((first == 'l' || first == 'r') && !begins(bare) && begins(bare.substr(1))) {
    bare.erase(0, 1);
    return first == 'l' ? Side::left : Side::right;
  }
  const std::string head = bare.substr(0, bare.size() - 1);
  if ((last == 'l' || last == 'r') && part_of(bare) == part_of(head) &&
      part_of(head) > Part::head &&
      std::any_of(vocabulary().begin(), vocabulary().end(), [&](const Vocabulary& v) {
        const std::string word = v.word;
        return head.size() >= word.size() &&
               head.compare(head.size() - word.size(), word.size(), word) == 0;
      })) {
    bare.pop_back();
    return last == 'l' ? Side::left : Side::right;
  }
  return Side::none;
}

// How many leading characters most names have alike: over three quarters of them.
std::size_t common_prefix(const std::vector<std::string>& names) {
  std::size_t best = 0;
  if (names.size() < 8) return 0;
  for (const std::string& sample : {names[names.size() / 3], names[names.size() / 2]}) {
    std::size_t length = 0;
    for (std::size_t n = 1; n < sample.size(); ++n) {
      const auto alike = std::count_if(names.begin(), names.end(), [&](const std::string& name) {
        return name.compare(0, n, sample, 0, n) == 0;
      });
      if (4 * static_cast<std::size_t>(alike) < 3 * names.size()) break;
      length = n;
    }
    best = std::max(best, length);
  }
  return best;
}

// Without the namespace, and without the prefix of the others where it has it.
std::string without_prefix(const std::string& name, const std::string& prefix) {
  std::string rest = name;
  if (rest.size() > prefix.size() && rest.compare(0, prefix.size(), prefix) == 0)
    rest.erase(0, prefix.size());
  const std::size_t mark = rest.find_last_of(":|");
  return mark == rest.npos || mark + 1 == rest.size() ? rest : rest.substr(mark + 1);
}

}  // namespace

std::vector<JointWord> joint_words(const std::vector<std::string>& names) {
  std::vector<std::string> plain;
  for (const std::string& name : names) plain.push_back(without_prefix(name, ""));
  const std::size_t length = common_prefix(plain);
  const std::string prefix =
      length == 0 ? ""
      : plain[plain.size() / 3].compare(0, length, plain[plain.size() / 2], 0, length) == 0
          ? plain[plain.size() / 2].substr(0, length)
          : "";
  std::vector<JointWord> all;
  for (const std::string& name : plain) {
    JointWord word;
    const std::vector<std::string> parts = words_of(without_prefix(name, prefix));
    for (const std::string& part : parts) {
      // "L5" alone is a vertebra.
      const Side side = parts.size() == 1 && part.size() == 1 ? Side::none : side_of_word(part);
      if (side != Side::none && word.side == Side::none)
        word.side = side;
      else
        word.bare += part;
    }
    if (word.side == Side::none) word.side = glued_side(word.bare);
    word.part = part_of(word.bare);
    all.push_back(word);
  }
  return all;
}

}  // namespace mocaplm
