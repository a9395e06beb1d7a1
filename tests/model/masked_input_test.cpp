// What a masked model sees, against slow definitions and against changes of what is hidden.
#include "model/masked_input.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/error.h"
#include "model/directory.h"
#include "support/small_models.h"

namespace mocaplm::masked_input_test {
namespace {

ModelDescription masked_description() {
  ModelDescription d = small_description();
  d.config.objective = "masked";
  return d;
}

// Hides each bin with the given chance.
std::vector<std::int32_t> hide(std::vector<std::int32_t> ids, double share, Random& random) {
  for (std::int32_t& id : ids)
    if (id >= 4 && random.uniform() < share) id = 1;
  return ids;
}

using Value = std::optional<std::int64_t>;

struct Slow {
  std::vector<std::int32_t> ids;

  Value bin(std::int64_t frame, std::int64_t channel) const {
    const std::int64_t at = 4 * frame + channel;
    if (frame < 0 || at >= static_cast<std::int64_t>(ids.size()) || channel == 3) return {};
    const std::int64_t b = ids[static_cast<std::size_t>(at)] - 4;
    return b >= 0 ? Value(b) : Value();
  }
  Value expected(std::int64_t t, std::int64_t c) const {
    Value low, high;
    std::int64_t before = 0, after = 0;
    for (std::int64_t k = 1; k < 100 && !low; ++k) low = bin(t - k, c), before = k;
    for (std::int64_t k = 1; k < 100 && !high; ++k) high = bin(t + k, c), after = k;
    if (low && high)
      return std::lround(static_cast<double>(*low * after + *high * before) /
                         static_cast<double>(after + before));
    if (low && before == 1 && bin(t - 2, c)) return 2 * *low - *bin(t - 2, c);
    if (high && after == 1 && bin(t + 2, c)) return 2 * *high - *bin(t + 2, c);
    return low ? low : high;
  }
  static std::int32_t row(const Value& a, const Value& b) {
    if (!a || !b) return 0;
    return static_cast<std::int32_t>(
        6 + std::max<std::int64_t>(-5, std::min<std::int64_t>(5, *a - *b)));
  }
};

TEST(MaskedInput, AgreesWithTheDefinitions) {
  const ModelDescription d = masked_description();
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    Slow slow{hide(random_stream(d.shape, 1 + static_cast<std::int64_t>(random.below(5)), random),
                   random.uniform(), random)};
    slow.ids.resize(1 + random.below(slow.ids.size()));  // the last frame may be unfinished
    const std::vector<std::int32_t> prefix = {2, 15};
    const ModelInput input = masked_input(d, prefix, slow.ids);
    ASSERT_EQ(input.size(), 2 + slow.ids.size());
    EXPECT_NO_THROW(check_input(input, d, "window"));
    for (std::size_t i = 0; i < slow.ids.size(); ++i) {
      const auto t = static_cast<std::int64_t>(i / 4), c = static_cast<std::int64_t>(i % 4);
      const std::size_t p = i + 2;
      EXPECT_EQ(input.token[p], slow.ids[i]);
      EXPECT_EQ(input.frame[p], t + 1);
      EXPECT_EQ(input.channel[p], c);
      const Value centre = c == 3 ? Value() : slow.expected(t, c);
      // Halves may be rounded either way.
      if (centre)
        EXPECT_LE(std::abs(input.centre[p] - *centre), 1) << i;
      else
        EXPECT_EQ(input.centre[p], kNoCentre) << i;
      const Value own = input.centre[p] == kNoCentre ? Value() : Value(input.centre[p]);
      EXPECT_EQ(input.surprise[p], Slow::row(slow.bin(t, c), own));
      EXPECT_EQ(input.velocity[p], Slow::row(slow.bin(t - 1, c), slow.bin(t - 2, c)));
      EXPECT_EQ(input.last_surprise[p], Slow::row(slow.bin(t + 2, c), slow.bin(t + 1, c)));
    }
    for (std::size_t p = 0; p < 2; ++p) {
      EXPECT_EQ(input.token[p], prefix[p]);
      EXPECT_EQ(input.centre[p], kNoCentre);
      EXPECT_EQ(input.surprise[p] + input.velocity[p] + input.last_surprise[p], 0);
    }
  }
}

TEST(MaskedInput, AWorkedExample) {
  const ModelDescription d = masked_description();  // bins from id 4
  // Channel 0 holds bins 2, hidden, hidden, 8, 9: the line between 2 and 8 is 4, 6.
  const std::vector<std::int32_t> ids = {6, 1, 4,  3, 1, 1, 4,  3, 1, 1,
                                         4, 3, 12, 1, 4, 3, 13, 1, 4, 3};
  const ModelInput input = masked_input(d, {2}, ids);
  EXPECT_EQ(input.centre[1 + 4], 4);
  EXPECT_EQ(input.centre[1 + 8], 6);
  EXPECT_EQ(input.centre[1 + 0], 8);   // the nearest known one, for the next frame is hidden
  EXPECT_EQ(input.centre[1 + 16], 8);  // its own bin 9 is not looked at, nor one before 8
  EXPECT_EQ(input.last_surprise[1 + 8], 6 + 1);
  EXPECT_EQ(input.centre[1 + 1], kNoCentre);
}

TEST(MaskedInput, CentralWindowsCoverEveryFrameOnce) {
  for (std::size_t room = 1; room < 12; ++room)
    for (std::size_t frames = 1; frames < 40; ++frames) {
      std::size_t next = 0;
      for (const CentralWindow& w : central_windows(frames, room)) {
        EXPECT_EQ(w.from, next);
        EXPECT_LT(w.from, w.to);
        EXPECT_LE(w.first, w.from);
        EXPECT_LE(w.to, w.last);
        EXPECT_LE(w.last, frames);
        EXPECT_EQ(w.last - w.first, std::min(room, frames));
        // Within the stream at least a fifth of the window lies on each side.
        if (w.first > 0 && w.last < frames) {
          EXPECT_GE(w.from - w.first + 1, room / 5);
        }
        if (w.last < frames) {
          EXPECT_GE(w.last - w.to + 1, room / 5);
        }
        next = w.to;
      }
      EXPECT_EQ(next, frames) << room;
    }
}

TEST(MaskedInput, MaskedModelsOfFramesAreRefused) {
  ModelDescription d = small_frames_description();
  d.config.objective = "masked";
  EXPECT_THROW(check_model(d), UsageError);
}

}  // namespace
}  // namespace mocaplm::masked_input_test
