// Why tiles tell the root's place and not its steps (docs/tokenizers.md): in a DCT the coefficients
// that are left out are the small ones, of slow steps, too; what they leave out adds up.
#include <gtest/gtest.h>

#include <cstdio>

#include "motion/skeleton.h"
#include "motion/synth.h"
#include "support/refusal.h"
#include "tokenizer/random_clips.h"
#include "tokenizer/root_motion.h"
#include "tokenizer/tiles.h"

namespace mocaplm::tile_root_test {
namespace {

// The last three columns, (x, y, z) as TileTokenizer tells them, as (left, y, forward) steps.
Eigen::MatrixXd as_steps(Eigen::MatrixXd values) {
  const Eigen::Index root = values.cols() - 3;
  const Eigen::MatrixXd place = values.rightCols<3>();
  for (Eigen::Index t = 0; t < values.rows(); ++t) {
    const Eigen::Index before = std::max<Eigen::Index>(t - 1, 0);
    const Eigen::Vector2d step =
        to_dancer({place(t, 0) - place(before, 0), place(t, 2) - place(before, 2)},
                  heading_direction(values.row(t).head<3>().transpose()));
    values(t, root) = step.x();
    values(t, root + 2) = step.y();
  }
  return values;
}

// And back, along the decoded heading.
Eigen::MatrixXd as_places(Eigen::MatrixXd values) {
  const Eigen::Index root = values.cols() - 3;
  Eigen::Vector2d at(0, 0);
  for (Eigen::Index t = 0; t < values.rows(); ++t) {
    at += to_floor({values(t, root), values(t, root + 2)},
                   heading_direction(values.row(t).head<3>().transpose()));
    values(t, root) = at.x();
    values(t, root + 2) = at.y();
  }
  return values;
}

struct RootError {
  double mean = 0, last = 0;  // over all frames and over the clips' last ones, cm
  std::size_t characters = 0;
};

RootError root_error(const std::vector<Eigen::MatrixXd>& clips, bool steps) {
  TokenizerConfig frames;
  frames.fps = 60;
  frames.root = "absolute";
  frames.bins = 2000;
  TileConfig tiles;
  tiles.tiles = 60;
  tiles.keep = 0.1;
  tiles.lapped = true;
  std::vector<Eigen::MatrixXd> told;
  for (const Eigen::MatrixXd& clip : clips) told.push_back(steps ? as_steps(clip) : clip);
  const TileTokenizer tokenizer = TileTokenizer::fit_values(frames, tiles, told);
  RootError error;
  double count = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const TokenStream stream = tokenizer.encode_values(told[i]);
    Eigen::MatrixXd back = tokenizer.decode_values(stream.ids, "t").topRows(clips[i].rows());
    if (steps) back = as_places(back);
    const Eigen::VectorXd off =
        100 * (back.rightCols<3>() - clips[i].rightCols<3>()).rowwise().norm();
    error.mean += off.sum();
    error.last += off[off.size() - 1] / static_cast<double>(clips.size());
    count += static_cast<double>(off.size());
    error.characters += stream.size();
  }
  error.mean /= count;
  return error;
}

// The dances of `mocaplm synth`, 20 seconds each.
TEST(TileRoot, StepsDriftAndPlacesDoNot) {
  SynthConfig config;
  config.genres = {"WA", "HO", "BR"};
  config.dancers = 1;
  config.choreographies = 3;
  config.seconds = 20;
  std::vector<Eigen::MatrixXd> clips;
  TokenizerConfig frames;
  frames.fps = 60;
  frames.root = "absolute";
  const std::vector<int> joints = parse_joints(frames.joints);
  for (const Dance& dance : plan_dances(config))
    clips.push_back(TileTokenizer::channel_values(frames, joints, make_dance(dance, config)));
  const RootError places = root_error(clips, false), steps = root_error(clips, true);
  std::printf(
      "root, cm off: places %.1f (at the end %.1f), steps %.1f (at the end %.1f); %zu and "
      "%zu characters\n",
      places.mean, places.last, steps.mean, steps.last, places.characters, steps.characters);
  EXPECT_LT(places.last, 2 * places.mean) << "no drift";
  EXPECT_GT(steps.mean, 10 * places.mean);
  EXPECT_GT(steps.last, 1.2 * steps.mean) << "the longer, the farther";
}

// The conversion itself loses nothing.
TEST(TileRoot, StepsAndBackAreTheSame) {
  TokenizerConfig frames;
  frames.fps = 20;
  frames.root = "absolute";
  const Eigen::MatrixXd values =
      TileTokenizer::channel_values(frames, parse_joints(frames.joints), random_clip(3, 80));
  EXPECT_LT((as_places(as_steps(values)) - values).norm(), 1e-9);
}

}  // namespace
}  // namespace mocaplm::tile_root_test
