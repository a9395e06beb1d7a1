// Filling hidden tokens: only they change, the surest come first, windows slide over long streams.
#include "infill/fill.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/angles.h"
#include "model/masked_input.h"
#include "support/random_model.h"
#include "support/small_models.h"

namespace mocaplm::fill_test {
namespace {

struct Case {
  ModelDescription d;
  std::shared_ptr<LanguageModel> model;
  std::vector<std::int32_t> ids;

  explicit Case(std::int64_t frames, std::uint64_t seed = 3) : d(small_description()) {
    d.config.objective = "masked";
    model = random_model(d, 11);
    Random random(seed);
    ids = random_stream(d.shape, frames, random);
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (i % 4 != 3 && random.below(3) == 0) ids[i] = 1;
  }
  std::vector<std::int32_t> fill(const FillOptions& options) {
    return fill_hidden(*model, {2}, ids, 1, {11, 11, 7}, options);
  }
};

TEST(FillHidden, FillsWhatIsHiddenAndNothingElse) {
  for (const std::int64_t frames : {2, 5, 23}) {
    Case c(frames);
    for (const std::int64_t rounds : {1, 4, 30}) {
      std::int64_t told = 0;
      const auto filled = fill_hidden(*c.model, {2}, c.ids, 1, {11, 11, 7}, {rounds, 0, 1},
                                      [&](std::int64_t round) { EXPECT_EQ(round, ++told); });
      EXPECT_EQ(told, rounds);
      ASSERT_EQ(filled.size(), c.ids.size());
      for (std::size_t i = 0; i < filled.size(); ++i) {
        if (c.ids[i] != 1) {
          EXPECT_EQ(filled[i], c.ids[i]);
        }
        EXPECT_GE(filled[i], 3);
        if (c.ids[i] == 1) {
          EXPECT_LT(filled[i], 4 + (i % 4 == 2 ? 7 : 11));
        }
      }
    }
  }
}

// Within one window: each round the plain way, one position at a time.
TEST(FillHidden, TakesTheSurestFirst) {
  Case c(5);
  const at::NoGradGuard no_grad;
  std::vector<std::int32_t> ids = c.ids;
  const auto all = static_cast<double>(std::count(ids.begin(), ids.end(), 1));
  constexpr int kRounds = 5;
  for (int round = 1; round <= kRounds; ++round) {
    ModelInput input = masked_input(c.d, {2}, ids);
    while (input.size() < 24) append_prefix(input, c.d, 0, false, ids, 0);
    const Batch batch = stack({input});
    const at::Tensor logits = c.model->logits(c.model->hidden(batch), batch)[0];
    std::set<std::tuple<double, std::size_t, std::int32_t>> order;  // -probability, place, id
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (ids[i] != 1) continue;
      const at::Tensor share = at::softmax(
          logits[static_cast<std::int64_t>(1 + i)].slice(0, 4, 4 + (i % 4 == 2 ? 7 : 11)), 0);
      const auto best = share.argmax().item<std::int64_t>();
      order.insert({-share[best].item<double>(), i, static_cast<std::int32_t>(4 + best)});
    }
    const auto left =
        round == kRounds ? 0 : static_cast<std::size_t>(all * std::cos(kPi / 2 * round / kRounds));
    std::size_t taken = 0;
    for (const auto& [probability, place, id] : order)
      if (taken++ + left < order.size()) ids[place] = id;
  }
  EXPECT_EQ(c.fill({kRounds, 0, 1}), ids);
}

TEST(FillHidden, DrawsBySeed) {
  Case c(23);
  const auto a = c.fill({4, 1, 5}), b = c.fill({4, 1, 5}), other = c.fill({4, 1, 6});
  EXPECT_EQ(a, b);
  EXPECT_NE(a, other);
  EXPECT_EQ(c.fill({4, 0, 5}), c.fill({4, 0, 6}));
}

TEST(FillHidden, NothingHiddenStaysAsItIs) {
  Case c(9);
  for (std::int32_t& id : c.ids)
    if (id == 1) id = 6;
  EXPECT_EQ(c.fill({3, 0, 1}), c.ids);
}

}  // namespace
}  // namespace mocaplm::fill_test
