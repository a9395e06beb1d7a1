#include "motion/formats/joint_vocabulary.h"

#include <algorithm>
#include <map>
#include <set>

#include "common/text.h"

namespace mocaplm {

namespace {

// What a name says before the other names tell what it means.
enum Word {
  kNothing = -1,
  kHipWord,
  kKneeWord,
  kAnkleWord,
  kFootWord,
  kToeWord,
  kHeelWord,
  kShoulderWord,
  kUpperArmWord,
  kElbowWord,
  kWristWord,
  kHandWord,
  kKnuckleWord,
  kCollarWord,
  kEarWord,
  kSidedWords,
  kPelvisWord = kSidedWords,
  kSpine1Word,
  kSpine2Word,
  kSpine3Word,
  kNeckWord,
  kHeadWord,
  kTopWord,
  kNoseWord,
  kWords
};

struct Meaning {
  Word word = kNothing;
  int side = -1;  // 0 left, 1 right, -1 in the middle
};

const std::map<std::string, Word>& sided_words() {
  static const std::map<std::string, Word> words = {
      {"hip", kHipWord},          {"upleg", kHipWord},         {"upperleg", kHipWord},
      {"thigh", kHipWord},        {"femur", kHipWord},         {"h", kHipWord},
      {"knee", kKneeWord},        {"leg", kKneeWord},          {"lowerleg", kKneeWord},
      {"shin", kKneeWord},        {"calf", kKneeWord},         {"tibia", kKneeWord},
      {"k", kKneeWord},           {"ankle", kAnkleWord},       {"a", kAnkleWord},
      {"foot", kFootWord},        {"bigtoe", kToeWord},        {"toe", kToeWord},
      {"toes", kToeWord},         {"toebase", kToeWord},       {"footindex", kToeWord},
      {"ball", kToeWord},         {"forefoot", kToeWord},      {"mtp", kToeWord},
      {"heel", kHeelWord},        {"shoulder", kShoulderWord}, {"s", kShoulderWord},
      {"arm", kUpperArmWord},     {"upperarm", kUpperArmWord}, {"uparm", kUpperArmWord},
      {"humerus", kUpperArmWord}, {"elbow", kElbowWord},       {"forearm", kElbowWord},
      {"lowerarm", kElbowWord},   {"e", kElbowWord},           {"wrist", kWristWord},
      {"w", kWristWord},          {"hand", kHandWord},         {"index", kKnuckleWord},
      {"index1", kKnuckleWord},   {"middle1", kKnuckleWord},   {"knuckle", kKnuckleWord},
      {"collar", kCollarWord},    {"clavicle", kCollarWord},   {"sternoclavicular", kCollarWord},
      {"ear", kEarWord}};
  return words;
}

const std::map<std::string, Word>& middle_words() {
  static const std::map<std::string, Word> words = {
      {"pelvis", kPelvisWord}, {"hips", kPelvisWord},      {"hip", kPelvisWord},
      {"midhip", kPelvisWord}, {"root", kPelvisWord},      {"midhips", kPelvisWord},
      {"hipmid", kPelvisWord}, {"spinebase", kPelvisWord}, {"spine1", kSpine1Word},
      {"spine2", kSpine2Word}, {"spine3", kSpine3Word},    {"neck", kNeckWord},
      {"head", kHeadWord},     {"headtop", kTopWord},      {"tophead", kTopWord},
      {"topofhead", kTopWord}, {"vertex", kTopWord},       {"nose", kNoseWord}};
  return words;
}

// Letters and digits of what follows the last colon, in small letters, without "joint centre".
std::string bare(const std::string& name) {
  std::string text;
  for (const char c : lower(name.substr(name.rfind(':') + 1)))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) text += c;
  for (const char* end : {"jointcenter", "jointcentre", "center", "centre", "joint", "jc"}) {
    const std::size_t length = std::string(end).size();
    if (text.size() > length && text.compare(text.size() - length, length, end) == 0) {
      text.resize(text.size() - length);
      break;
    }
  }
  return text;
}

bool is_joint_centre(const std::string& name) {
  const std::string text = lower(name);
  return text.size() > 2 && text.compare(text.size() - 2, 2, "jc") == 0;
}

Meaning meaning_of(const std::string& name) {
  const std::string text = bare(name);
  if (const auto found = middle_words().find(text); found != middle_words().end())
    return {found->second, -1};
  const std::pair<const char*, int> sides[] = {{"left", 0}, {"right", 1}, {"l", 0}, {"r", 1}};
  for (const auto& [word, side] : sides) {
    const std::string mark = word;
    if (text.size() <= mark.size()) continue;
    for (const bool before : {true, false}) {
      const std::size_t at = before ? 0 : text.size() - mark.size();
      if (text.compare(at, mark.size(), mark) != 0) continue;
      const std::string rest =
          before ? text.substr(mark.size()) : text.substr(0, text.size() - mark.size());
      // "RHJC" without its "jc" is "rh": a single letter means a joint centre only.
      if (rest.size() == 1 && !is_joint_centre(name)) continue;
      if (const auto found = sided_words().find(rest); found != sided_words().end())
        return {found->second, side};
    }
  }
  return {};
}

}  // namespace

PointNames find_points(const std::vector<std::string>& names) {
  // [word][side, or 0 in the middle]: the index of the first name that says it.
  int said[kWords][2];
  for (auto& sides : said) sides[0] = sides[1] = -1;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Meaning meaning = meaning_of(names[i]);
    if (meaning.word == kNothing) continue;
    int& slot = said[meaning.word][std::max(0, meaning.side)];
    if (slot < 0) slot = static_cast<int>(i);
  }
  PointNames found;
  found.index.fill(-1);
  const auto set = [&](int point, int name) {
    found.index[static_cast<std::size_t>(point)] = name;
  };
  for (int side = 0; side < 2; ++side) {
    const auto word = [&](Word w) { return said[w][side]; };
    set(1 + side, word(kHipWord));
    set(4 + side, word(kKneeWord));
    const bool has_ankle = word(kAnkleWord) >= 0;
    set(7 + side, has_ankle ? word(kAnkleWord) : word(kFootWord));
    set(10 + side, word(kToeWord) >= 0 ? word(kToeWord) : has_ankle ? word(kFootWord) : -1);
    set(kLeftHeel + side, word(kHeelWord));
    const bool has_upper_arm = word(kUpperArmWord) >= 0;
    set(16 + side, has_upper_arm ? word(kUpperArmWord) : word(kShoulderWord));
    set(13 + side, word(kCollarWord) >= 0 ? word(kCollarWord)
                   : has_upper_arm        ? word(kShoulderWord)
                                          : -1);
    set(18 + side, word(kElbowWord));
    const bool has_wrist = word(kWristWord) >= 0;
    set(20 + side, has_wrist ? word(kWristWord) : word(kHandWord));
    set(22 + side, has_wrist && word(kHandWord) >= 0 ? word(kHandWord) : word(kKnuckleWord));
    set(kLeftEar + side, word(kEarWord));
  }
  set(0, said[kPelvisWord][0]);
  const bool spine =
      said[kSpine1Word][0] >= 0 && said[kSpine2Word][0] >= 0 && said[kSpine3Word][0] >= 0;
  if (spine) {
    set(3, said[kSpine1Word][0]);
    set(6, said[kSpine2Word][0]);
    set(9, said[kSpine3Word][0]);
  }
  // SMPL's neck and head lie inside the body; elsewhere a neck is between the shoulders, and a head
  // in the middle or on top of it.
  const bool smpl = spine && said[kNeckWord][0] >= 0;
  if (smpl || found.index[13] >= 0) set(12, said[kNeckWord][0]);
  set(smpl ? 15 : static_cast<int>(kHeadTop), said[kHeadWord][0]);
  if (said[kTopWord][0] >= 0) set(kHeadTop, said[kTopWord][0]);
  set(kNose, said[kNoseWord][0]);
  const std::set<int> used(found.index.begin(), found.index.end());
  for (std::size_t i = 0; i < names.size(); ++i)
    if (used.count(static_cast<int>(i)) == 0) found.left_out.push_back(names[i]);
  for (const int point : needed_points())
    if (found.index[static_cast<std::size_t>(point)] < 0)
      found.missing.push_back(point_name(point));
  return found;
}

bool are_skin_markers(const std::vector<std::string>& names) {
  static const std::set<std::string> middle = {"c7", "t10", "clav", "strn", "sacr", "rbak"};
  static const std::set<std::string> sided = {
      "asi", "psi", "asis", "psis",    "fhd",     "bhd",      "sho",      "elb",       "wra", "wrb",
      "fin", "thi", "kne",  "tib",     "ank",     "hee",      "toe",      "upa",       "frm", "mt5",
      "knm", "med", "gtr",  "kneelat", "kneemed", "anklelat", "anklemed", "kneemedial"};
  int count = 0;
  for (const std::string& name : names) {
    const std::string text = bare(name);
    if (middle.count(text) > 0 ||
        (text.size() > 1 && (text[0] == 'l' || text[0] == 'r') && sided.count(text.substr(1)) > 0))
      ++count;
  }
  return count >= 4;
}

}  // namespace mocaplm
