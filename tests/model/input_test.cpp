// What the model sees, against a slow computation from the definitions on a table of frames.
#include "model/input.h"

#include <gtest/gtest.h>

#include <optional>

#include "support/small_models.h"

namespace mocaplm::input_test {

namespace {

using Value = std::optional<std::int64_t>;

// The definitions of the thesis-like table bin[frame][channel]; nothing is shared with model/.
struct Slow {
  std::vector<std::int32_t> ids;
  StreamShape shape;
  std::int64_t reach;

  Value bin(std::int64_t frame, std::int64_t channel) const {
    const std::int64_t at = frame * (shape.channels + 1) + channel;
    if (frame < 0 || at >= static_cast<std::int64_t>(ids.size())) return {};
    const std::int64_t b = ids[static_cast<std::size_t>(at)] - shape.first_bin;
    return b >= 0 && b < shape.bins ? Value(b) : Value();
  }
  Value expected(std::int64_t frame, std::int64_t channel) const {
    const Value one = bin(frame - 1, channel), two = bin(frame - 2, channel);
    if (!one) return {};
    return two ? *one + (*one - *two) : *one;
  }
  std::int32_t row(const Value& a, const Value& b) const {
    if (!a || !b) return 0;
    const std::int64_t d = *a - *b;
    return static_cast<std::int32_t>(1 + reach + (d > reach ? reach : d < -reach ? -reach : d));
  }
};

void expect_position(const ModelInput& input, std::size_t p, const Slow& slow, std::int64_t index,
                     std::int64_t first, bool is_prefix) {
  const std::int64_t per = slow.shape.channels + 1;
  const std::int64_t frame = index / per, channel = index % per;
  const std::int64_t next = is_prefix ? first : index + 1;
  const std::int64_t nf = next / per, nc = next % per;
  SCOPED_TRACE("position " + std::to_string(p));
  if (!is_prefix) {
    EXPECT_EQ(input.token[p], slow.ids[static_cast<std::size_t>(index)]);
    EXPECT_EQ(input.frame[p], 1 + (index - first) / per);
    EXPECT_EQ(input.channel[p], channel);
    EXPECT_EQ(input.surprise[p], slow.row(slow.bin(frame, channel), slow.expected(frame, channel)));
  }
  const Value centre = slow.expected(nf, nc);
  EXPECT_EQ(input.centre[p], centre ? *centre : kNoCentre);
  EXPECT_EQ(input.velocity[p], slow.row(slow.bin(nf - 1, nc), slow.bin(nf - 2, nc)));
  EXPECT_EQ(input.last_surprise[p], slow.row(slow.bin(nf - 1, nc), slow.expected(nf - 1, nc)));
}

// Random streams, now and then with a token that is no bin where a bin should be.
std::vector<std::int32_t> stream_with_holes(const StreamShape& shape, std::int64_t frames,
                                            Random& random) {
  std::vector<std::int32_t> ids = random_stream(shape, frames, random);
  for (std::int32_t& id : ids)
    if (random.below(12) == 0) id = static_cast<std::int32_t>(random.below(2));
  return ids;
}

TEST(ModelInput, WindowsAgreeWithTheDefinitions) {
  Random random(1);
  const ModelDescription model = small_description();
  for (int round = 0; round < 200; ++round) {
    const Slow slow{stream_with_holes(model.shape, 12, random), model.shape, model.config.reach};
    const std::size_t first = 4 * random.below(8);
    const std::size_t count = random.below(slow.ids.size() - first + 1);
    const std::vector<std::int32_t> prefix(1 + random.below(3), 2);
    const ModelInput input = window_input(model, prefix, slow.ids, first, count);
    ASSERT_EQ(input.size(), prefix.size() + count);
    for (std::size_t p = 0; p + 1 < prefix.size(); ++p) {
      EXPECT_EQ(input.centre[p], kNoCentre);
      EXPECT_EQ(input.velocity[p] + input.last_surprise[p] + input.surprise[p], 0);
    }
    for (std::size_t p = 0; p < prefix.size(); ++p) {
      EXPECT_EQ(input.token[p], 2);
      EXPECT_EQ(input.frame[p], 0);
      EXPECT_EQ(input.channel[p], model.shape.channels + 1);
    }
    expect_position(input, prefix.size() - 1, slow, 0, static_cast<std::int64_t>(first), true);
    for (std::size_t i = 0; i < count; ++i)
      expect_position(input, prefix.size() + i, slow, static_cast<std::int64_t>(first + i),
                      static_cast<std::int64_t>(first), false);
    if (HasFailure()) FAIL() << "in round " << round;
  }
}

TEST(ModelInput, AWorkedExample) {
  const ModelDescription model = small_description();  // bins from id 4, reach 5
  // Channel 0: bins 2, 5, 9: expected 2 then 8.
  const std::vector<std::int32_t> ids = {6, 4, 4, 3, 9, 4, 4, 3, 13, 4, 4, 3};
  const StreamHistory history(model.shape, 5);
  EXPECT_EQ(history.centre(ids, 0), kNoCentre);
  EXPECT_EQ(history.centre(ids, 4), 2);
  EXPECT_EQ(history.centre(ids, 8), 8);
  EXPECT_EQ(history.centre(ids, 12), 13);         // outside the 11 bins, and said so
  EXPECT_EQ(history.centre(ids, 11), kNoCentre);  // a separator comes next
  EXPECT_EQ(history.surprise_row(ids, 8), 1 + 5 + 1);
  EXPECT_EQ(history.surprise_row(ids, 4), 1 + 5 + 3);
  EXPECT_EQ(history.velocity_row(ids, 8), 1 + 5 + 3);
  EXPECT_EQ(history.last_surprise_row(ids, 12), 1 + 5 + 1);
  EXPECT_EQ(history.surprise_row(ids, 0), 0);
}

bool same_position(const ModelInput& a, const ModelInput& b, std::size_t p) {
  return a.token[p] == b.token[p] && a.frame[p] == b.frame[p] && a.channel[p] == b.channel[p] &&
         a.centre[p] == b.centre[p] && a.surprise[p] == b.surprise[p] &&
         a.velocity[p] == b.velocity[p] && a.last_surprise[p] == b.last_surprise[p];
}

TEST(ModelInput, NothingSeesTheFuture) {
  Random random(2);
  const ModelDescription model = small_description();
  for (int round = 0; round < 100; ++round) {
    const std::vector<std::int32_t> ids = random_stream(model.shape, 10, random);
    const std::size_t first = 4 * random.below(5), count = ids.size() - first;
    const std::size_t at = random.below(ids.size());
    std::vector<std::int32_t> changed = ids;
    for (std::size_t i = at; i < ids.size(); ++i)
      changed[i] = static_cast<std::int32_t>(random.below(15));
    const ModelInput before = window_input(model, {2}, ids, first, count);
    const ModelInput after = window_input(model, {2}, changed, first, count);
    // A stream that ends before `at` gives the same too: nothing waits for what comes.
    const std::vector<std::int32_t> cut(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(at));
    const std::size_t known = at > first ? at - first : 0;
    const ModelInput shorter = window_input(model, {2}, cut, first, known);
    for (std::size_t p = 0; p < 1 + known; ++p) {
      if (at < first) break;  // the change lies before the window, in the history it may see
      ASSERT_TRUE(same_position(before, after, p)) << "changed from " << at << ", position " << p;
      ASSERT_TRUE(same_position(before, shorter, p)) << "cut at " << at << ", position " << p;
    }
  }
}

TEST(ModelInput, AppendingOneByOneIsTheWindow) {
  Random random(3);
  const ModelDescription model = small_description();
  const std::vector<std::int32_t> ids = random_stream(model.shape, 9, random);
  const ModelInput whole = window_input(model, {2, 1}, ids, 8, ids.size() - 8);
  ModelInput grown = window_input(model, {2, 1}, {ids.begin(), ids.begin() + 8}, 8, 0);
  for (std::size_t i = 8; i < ids.size(); ++i)
    append_stream(grown, model, {ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(i) + 1}, 8,
                  i);
  ASSERT_EQ(grown.size(), whole.size());
  for (std::size_t p = 0; p < whole.size(); ++p) EXPECT_TRUE(same_position(grown, whole, p)) << p;
}

}  // namespace

}  // namespace mocaplm::input_test
