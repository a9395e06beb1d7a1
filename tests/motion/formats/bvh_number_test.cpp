#include "motion/formats/bvh_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "common/random.h"

namespace mocaplm::bvh_number_test {
namespace {

// Parses `text` as it stands in a file, with `after` behind it; the place where the number ended.
std::ptrdiff_t parse(const std::string& text, const std::string& after, double& value) {
  const std::string all = text + after;
  return parse_number(all.data(), all.data() + all.size(), value) - all.data();
}

// The C library's strtod reads the same forms and rounds to the nearest double. With much behind
// the number the short way is taken, with nothing behind it the library's.
void expect_as_strtod(const std::string& text) {
  char* end = nullptr;
  const double expected = std::strtod(text.c_str(), &end);
  ASSERT_EQ(*end, '\0') << text;
  for (const char* after :
       {"", " ", "\n-0.25 17.5 0.001 1234.5678 90\n", "\t33333333333333333333"}) {
    double value = -1;
    ASSERT_EQ(parse(text, after, value), static_cast<std::ptrdiff_t>(text.size())) << text << after;
    ASSERT_EQ(std::memcmp(&value, &expected, sizeof value), 0)
        << text << ": " << value << " for " << expected;
  }
}

TEST(BvhNumber, IsTheNearestDoubleOfAllForms) {
  for (const char* text : {"0",
                           "-0",
                           "0.0",
                           "-0.000000",
                           "5.",
                           ".5",
                           "-.5",
                           "007",
                           "1234567",
                           "12345678",
                           "123456789012",
                           "0.12345678",
                           "0.123456789",
                           "1234567.12345678",
                           "99.999999999999999999",
                           "1e5",
                           "1E5",
                           "1e-5",
                           "1.5e+05",
                           "-4.3199e-07",
                           "1.55038e-13",
                           "9007199254740993",
                           "2.5e22",
                           "2.5e-22",
                           "2.5e-23",
                           "1.5e100",
                           "1.5e-100",
                           "0.1e-1",
                           "9.9999999e0",
                           "3e00"})
    expect_as_strtod(text);
}

TEST(BvhNumber, IsTheNearestDoubleOfManyNumbers) {
  Random random(3);
  const char* const formats[] = {"%.6f",  "%g",   "%.8f", "%.5e",  "%.7g", "%.10f",
                                 "%.17g", "%.0f", "%.3f", "%.15g", "%.4f", "%.9g"};
  for (int i = 0; i < 200000; ++i) {
    const double value =
        random.uniform(-1, 1) * std::pow(10, static_cast<double>(random.below(12)) - 5);
    char text[64];
    std::snprintf(text, sizeof text, formats[random.below(std::size(formats))], value);
    expect_as_strtod(text);
  }
}

TEST(BvhNumber, TakesAPlusAndBoundsWhatADoubleCannotHold) {
  double value = 0;
  EXPECT_EQ(parse("+12.5", " 1 2 3 4 5 6 7 8 9 10 11 12", value), 5);
  EXPECT_EQ(value, 12.5);
  EXPECT_EQ(parse("1e-400", " 1 2 3 4 5 6 7 8 9 10 11 12", value), 6);
  EXPECT_EQ(value, 0);
  EXPECT_EQ(parse("1e400", "", value), 5);
  EXPECT_TRUE(std::isinf(value));
}

TEST(BvhNumber, StopsWhereTheNumberEnds) {
  const std::string after = " 1 2 3 4 5 6 7 8 9 10 11 12 13";
  double value = 0;
  for (const std::string text : {"x", "", "-", ".", "-.", "--1", "e5", "+-1", " 1", "+"})
    EXPECT_EQ(parse(text, after, value), 0) << text;
  EXPECT_EQ(parse("1x", after, value), 1);
  EXPECT_EQ(parse("1.5}", after, value), 3);
  EXPECT_EQ(parse("1.5.5", after, value), 3);
  EXPECT_EQ(parse("1.5e", after, value), 3);
  EXPECT_EQ(parse("1.5e-", after, value), 3);
  EXPECT_EQ(parse("1-2", after, value), 1);
  EXPECT_EQ(parse("1.25\x80", after, value), 4);
}

}  // namespace
}  // namespace mocaplm::bvh_number_test
