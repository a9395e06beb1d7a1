// Procedural dances: labelled motion in AIST++'s naming (Li et al. 2021) made by rules from a seed,
// for trying everything out without any motion capture. Nobody danced them, and wherever they are
// shown they are called procedural.
//
// A genre is a vocabulary of figures (synth/vocabulary.h), a choreography a phrase of them
// (synth/choreography.h), a dancer a style (synth/style.h), music a tempo (synth/beat.h). Feet are
// planted or swing (synth/feet.h); the legs follow by inverse kinematics (synth/leg_ik.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "motion/dataset.h"
#include "motion/synth/choreography.h"

namespace mocaplm {

struct SynthConfig {
  std::int64_t seed = 1;
  std::vector<std::string> genres;  // codes such as "WA"; none: all ten
  std::int64_t dancers = 3;         // per genre
  std::int64_t choreographies = 4;  // per dancer, basic and advanced each
  double seconds = 10;              // per clip
  double fps = 60;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("seed", seed, 0, std::int64_t{1} << 53, "the same seed gives the same dances");
    v.texts("genres", genres,
            "genre codes, comma separated, of BR,PO,LO,MH,LH,HO,WA,KR,JS,JB (default: all)");
    v.integer("dancers", dancers, 1, 3, "dancers of each genre");
    v.integer("choreographies", choreographies, 1, 20,
              "choreographies of each dancer, basic and advanced each");
    v.number("seconds", seconds, 1, 600, "length of a clip");
    v.number("fps", fps, 10, 240, "frames per second");
  }
};

// One dance to be made.
struct Dance {
  std::string name;  // "gWA_sBM_cAll_d26_mWA2_ch03"
  std::string genre_code;
  Situation situation = Situation::basic;
  int dancer = 0;  // 0 to 2 within the genre
  int music = 0;   // 0 to 5
  int choreography = 1;
  std::string
      split;  // every dancer has clips in train; validation and test hold other phrases or music
};

// All dances of a configuration in order of their names. Throws UsageError for an unknown genre.
std::vector<Dance> plan_dances(const SynthConfig& config);

// Makes one; the same arguments give bitwise the same clip.
Clip make_dance(const Dance& dance, const SynthConfig& config);

// Makes them all and writes the dataset; an existing dataset is replaced only when `overwrite`.
// Throws DataError when `out` holds anything else. `threads` 0: all cores.
Dataset write_dances(const SynthConfig& config, const std::filesystem::path& out, bool overwrite,
                     std::int64_t threads);

}  // namespace mocaplm
