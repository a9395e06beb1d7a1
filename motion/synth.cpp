#include "motion/synth.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "common/parallel.h"
#include "common/progress.h"
#include "common/random.h"
#include "common/settings.h"
#include "motion/dataset_write.h"
#include "motion/formats/aist.h"
#include "motion/synth/body.h"

namespace mocaplm {

namespace {

std::string two_digits(int number) {
  return (number < 10 ? "0" : "") + std::to_string(number);
}

std::string situation_code(Situation situation) {
  return situation == Situation::basic ? "sBM" : "sFM";
}

std::string name_of(const Dance& dance) {
  const Genre& genre = genre_by_code(dance.genre_code);
  return "g" + genre.code + "_" + situation_code(dance.situation) + "_cAll_d" +
         two_digits(genre.first_dancer + dance.dancer) + "_" +
         music_of(genre.code, dance.music).name + "_ch" + two_digits(dance.choreography);
}

// Each dancer holds one basic and one advanced dance back, one for validation and one for the test,
// changing roles from dancer to dancer; with one or two choreographies there is less to give.
std::string split_of(const Dance& dance, int genre_index, int choreographies) {
  const int turn = genre_index + dance.dancer;
  const bool basic = dance.situation == Situation::basic;
  const int held = 1 + (turn + (basic ? 0 : 1)) % choreographies;
  if (choreographies < 2 || dance.choreography != held) return "train";
  return basic == (turn % 2 == 0) ? "validation" : "test";
}

std::uint64_t seed_of(const SynthConfig& config, const std::string& what) {
  return stable_hash(what, static_cast<std::uint64_t>(config.seed));
}

// Everybody learns the basic choreographies; advanced ones are a dancer's own.
Random phrase_random(const Dance& dance, const SynthConfig& config) {
  std::string what = "phrase " + dance.genre_code + situation_code(dance.situation) +
                     std::to_string(dance.choreography);
  if (dance.situation == Situation::advanced) what += " of " + std::to_string(dance.dancer);
  return Random(seed_of(config, what));
}

}  // namespace

std::vector<Dance> plan_dances(const SynthConfig& config) {
  std::vector<std::string> codes = config.genres;
  if (codes.empty())
    for (const Genre& genre : genres()) codes.push_back(genre.code);
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  std::vector<Dance> dances;
  for (std::size_t g = 0; g < codes.size(); ++g)
    for (int dancer = 0; dancer < config.dancers; ++dancer)
      for (const Situation situation : {Situation::basic, Situation::advanced})
        for (int c = 1; c <= config.choreographies; ++c) {
          Dance dance;
          dance.genre_code = genre_by_code(codes[g]).code;
          dance.situation = situation;
          dance.dancer = dancer;
          dance.choreography = c;
          dance.music = (c + 2 * dancer + (situation == Situation::basic ? 0 : 3)) % 6;
          dance.split =
              split_of(dance, static_cast<int>(g), static_cast<int>(config.choreographies));
          dance.name = name_of(dance);
          dances.push_back(dance);
        }
  std::sort(dances.begin(), dances.end(),
            [](const Dance& a, const Dance& b) { return a.name < b.name; });
  return dances;
}

Clip make_dance(const Dance& dance, const SynthConfig& config) {
  const Genre& genre = genre_by_code(dance.genre_code);
  const Music music = music_of(genre.code, dance.music);
  const std::uint64_t own_seed = seed_of(config, dance.name);
  const Style style = on_the_day(
      dancer_style(static_cast<std::uint64_t>(config.seed), genre.code, dance.dancer), own_seed);
  Random phrase = phrase_random(dance, config), own(own_seed);
  const auto frames = static_cast<Eigen::Index>(std::lround(config.seconds * config.fps));
  const double beats = config.seconds / music.beat_seconds() + 2;
  const std::vector<Move> moves = compose(genre, dance.situation, beats, phrase);
  Clip clip = embody(perform(moves, genre, style, music, config.fps, frames, own));
  clip.name = dance.name;
  clip.labels = aist_labels(dance.name).value();
  check_clip(clip, dance.name);
  return clip;
}

Dataset write_dances(const SynthConfig& config, const std::filesystem::path& out, bool overwrite,
                     std::int64_t threads) {
  const std::vector<Dance> dances = plan_dances(config);
  Dataset dataset;
  dataset.procedural = true;
  dataset.import = Json{{"command", "synth"}};
  dataset.import.update(settings_json(config));
  dataset.entries.resize(dances.size());
  const Existing existing = overwrite ? Existing::replace : Existing::refuse;
  write_dataset(out, existing, [&](const std::filesystem::path& directory) {
    Progress progress("making procedural dances", dances.size(), "clips");
    std::mutex mutex;
    parallel_for(dances.size(), threads, [&](std::size_t i) {
      const Clip clip = make_dance(dances[i], config);
      DatasetEntry& entry = dataset.entries[i];
      entry = {clip.name, clip_file(clip.name), clip.frames(), clip.fps, clip.labels,
               clip.name, dances[i].split,      "procedural"};
      store_clip(directory, entry, clip);
      const std::lock_guard<std::mutex> lock(mutex);
      progress.add();
    });
    progress.finish();
    return dataset;
  });
  dataset.directory = out;
  return dataset;
}

}  // namespace mocaplm
