#include "motion/formats/recognise_guess.h"

#include <initializer_list>

namespace mocaplm {

namespace {

class Guess {
 public:
  explicit Guess(std::array<int, kJoints>& joints) : joints_(joints) {}

  void add(const JointWord& word, int joint) {
    const bool sided = word.side != Side::none;
    const int right = word.side == Side::right ? 1 : 0;
    switch (word.part) {
      case Part::pelvis:
        return take(joint, {0});
      case Part::spine:
        return take(joint, {3, 6, 9});
      case Part::neck:
        return take(joint, {12});
      case Part::head:
        return take(joint, {15});
      case Part::hip:
        return sided ? take(joint, {1 + right}) : take(joint, {0});
      case Part::thigh:
        return sided ? take(joint, {1 + right}) : void();
      case Part::leg:
        return sided ? take(joint, {1 + right, 4 + right}) : void();
      case Part::shin:
        return sided ? take(joint, {4 + right}) : void();
      case Part::foot_or_ankle:
        return sided ? take(joint, {7 + right}) : void();
      case Part::toe:
        return sided ? take(joint, {10 + right}) : void();
      case Part::collar:
      case Part::shoulder_or_collar:
        return sided ? take(joint, {13 + right}) : void();
      case Part::upper_arm:
        return sided ? take(joint, {16 + right}) : void();
      case Part::arm:
        return sided ? take(joint, {16 + right, 18 + right}) : void();
      case Part::forearm:
        return sided ? take(joint, {18 + right}) : void();
      case Part::hand:
        return sided ? take(joint, {20 + right}) : void();
      case Part::unknown:
      case Part::helper:
      case Part::finger:
        return;
    }
  }

 private:
  // The first of SMPL's joints that has none yet.
  void take(int joint, std::initializer_list<int> smpl) {
    for (const int j : smpl)
      if (joints_[static_cast<std::size_t>(j)] < 0) {
        joints_[static_cast<std::size_t>(j)] = joint;
        return;
      }
  }

  std::array<int, kJoints>& joints_;
};

}  // namespace

void guess_by_words(const std::vector<JointWord>& words, std::array<int, kJoints>& joints) {
  Guess guess(joints);
  for (std::size_t i = 0; i < words.size(); ++i) guess.add(words[i], static_cast<int>(i));
}

}  // namespace mocaplm
