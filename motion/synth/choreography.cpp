#include "motion/synth/choreography.h"

#include "common/angles.h"

namespace mocaplm {

namespace {

const std::string& draw(const std::vector<std::pair<std::string, double>>& choices,
                        Random& random) {
  double total = 0;
  for (const auto& [name, weight] : choices) total += weight;
  double at = random.uniform(0, total);
  for (const auto& [name, weight] : choices) {
    if (at < weight) return name;
    at -= weight;
  }
  return choices.back().first;
}

// Nobody sets a figure twice in quite the same way.
ArmFigure varied(ArmFigure figure, Random& random) {
  const auto shift = [&](ArmPose& pose, double size) {
    pose = pose + ArmPose{0.16 * size * random.normal(), 0.16 * size * random.normal(),
                          0.16 * size * random.normal(), 0.18 * size * random.normal(), 0};
  };
  shift(figure.from, 1);
  shift(figure.to, figure.curve == Curve::circle ? 0.4 : 1);
  const double other = random.uniform();
  if (other < 0.15) figure.hands = Hands::alternate;
  if (other > 0.85) figure.hands = Hands::canon;
  return figure;
}

TorsoFigure varied(TorsoFigure figure, Random& random) {
  for (double TorsoPose::*part : {&TorsoPose::pitch, &TorsoPose::roll, &TorsoPose::twist,
                                  &TorsoPose::look, &TorsoPose::down, &TorsoPose::hip_roll})
    figure.amount.*part *= random.uniform(0.7, 1.3);
  figure.amount.look += 0.15 * random.normal();
  return figure;
}

void turn_with_steps(FootFigure& figure, double angle) {
  for (Step& step : figure.steps) step.turn += angle / static_cast<double>(figure.steps.size());
}

Move draw_move(const Genre& genre, Situation situation, Random& random) {
  Move move;
  move.arms = varied(arm_figure(draw(genre.arms, random)), random);
  move.torso = varied(torso_figure(draw(genre.torsos, random)), random);
  move.feet = foot_figure(draw(genre.feet, random));
  if (random.uniform() < genre.turning * (situation == Situation::advanced ? 1 : 0.4))
    turn_with_steps(move.feet, (random.uniform() < 0.5 ? -1 : 1) * kPi / 2);
  return move;
}

std::vector<Move> basic_phrase(const Genre& genre, Random& random) {
  std::vector<Move> phrase(2);
  for (Move& move : phrase) move = draw_move(genre, Situation::basic, random);
  // A B A B, then the same on the other side.
  phrase.insert(phrase.end(), phrase.begin(), phrase.begin() + 2);
  phrase.insert(phrase.end(), phrase.begin(), phrase.begin() + 4);
  for (std::size_t i = 4; i < 8; ++i) phrase[i].flipped = true;
  for (std::size_t i = 3; i < 8; i += 4) phrase[i].freeze = random.uniform() < genre.freeze;
  return phrase;
}

Move vary(Move move, const Genre& genre, Random& random) {
  move.beats = random.uniform() < 0.45 ? 2 : 4;
  move.size = random.uniform(0.75, 1.4);
  move.flipped = random.uniform() < 0.5;
  move.freeze = random.uniform() < genre.freeze + 0.1;
  // Double time only where the arm has not far to go.
  if (random.uniform() < 0.3 && move.arms.rate <= 0.5 && move.size < 1.1) move.arms.rate *= 2;
  return move;
}

std::vector<Move> advanced_phrase(const Genre& genre, Random& random) {
  std::vector<Move> known(5 + random.below(3));
  for (Move& move : known) move = draw_move(genre, Situation::advanced, random);
  std::vector<Move> phrase;
  for (int i = 0; i < 12; ++i) {
    Move move = known[random.below(known.size())];
    if (random.uniform() < 0.4) move.arms = known[random.below(known.size())].arms;
    if (random.uniform() < 0.3) move.torso = known[random.below(known.size())].torso;
    phrase.push_back(vary(move, genre, random));
  }
  return phrase;
}

}  // namespace

std::vector<Move> compose(const Genre& genre, Situation situation, double beats, Random& random) {
  const std::vector<Move> phrase =
      situation == Situation::basic ? basic_phrase(genre, random) : advanced_phrase(genre, random);
  std::vector<Move> moves;
  for (double done = 0; done < beats; done += moves.back().beats)
    moves.push_back(phrase[moves.size() % phrase.size()]);
  return moves;
}

}  // namespace mocaplm
