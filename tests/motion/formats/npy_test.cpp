#include "motion/formats/npy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "motion/formats/helpers.h"

namespace mocaplm::npy_test {
namespace {

// A .npy file of any version and header, written here independently of npy_bytes.
std::string npy(const std::string& header, const std::string& data, int version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i)
    bytes += static_cast<char>(header.size() >> (8 * i) & 0xff);
  return bytes + header + data;
}

std::string header(const std::string& descr, const std::string& shape, bool fortran = false) {
  return "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") +
         ", 'shape': " + shape + ", }  \n";
}

template <class T>
std::string raw(std::vector<T> values, bool swap = false) {
  std::string bytes;
  for (const T value : values) {
    std::string one(reinterpret_cast<const char*>(&value), sizeof value);
    bytes += swap ? std::string(one.rbegin(), one.rend()) : one;
  }
  return bytes;
}

void expect_values(const std::string& bytes, std::vector<double> values) {
  const NumpyArray array = parse_npy(bytes, "a.npy");
  ASSERT_EQ(array.rows() * array.columns(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(array.at(i / array.columns(), i % array.columns()), values[i]) << i;
}

TEST(Npy, ReadsEveryVersionAndNumberType) {
  for (int version : {1, 2, 3})
    expect_values(npy(header("<f8", "(2, 2)"), raw<double>({1, -2.5, 3e300, 1e-310}), version),
                  {1, -2.5, 3e300, 1e-310});
  expect_values(npy(header("<f4", "(3,)"), raw<float>({1.5f, -0.25f, 3e30f})),
                {1.5, -0.25, static_cast<double>(3e30f)});
  expect_values(npy(header(">f8", "(2,)"), raw<double>({1.25, -7}, true)), {1.25, -7});
  expect_values(npy(header(">f4", "(2,)"), raw<float>({1.25f, -7}, true)), {1.25, -7});
  expect_values(npy(header("<f2", "(5,)"), raw<std::uint16_t>({0x3c00, 0xc100, 0x0001, 0x7bff, 0})),
                {1, -2.5, std::ldexp(1, -24), 65504, 0});
  expect_values(npy(header("<i8", "(2,)"), raw<std::int64_t>({-5, 1ll << 40})),
                {-5, 1099511627776.});
  expect_values(npy(header("<i4", "(2,)"), raw<std::int32_t>({-5, 70000})), {-5, 70000});
  expect_values(npy(header(">i2", "(2,)"), raw<std::int16_t>({-5, 300}, true)), {-5, 300});
  expect_values(npy(header("|i1", "(2,)"), raw<std::int8_t>({-5, 100})), {-5, 100});
  expect_values(npy(header("|u1", "(2,)"), raw<std::uint8_t>({251, 100})), {251, 100});
  expect_values(npy(header("<u8", "(1,)"), raw<std::uint64_t>({1ull << 63})), {0x1p63});
  expect_values(npy(header("|b1", "(2,)"), std::string("\1\0", 2)), {1, 0});
}

TEST(Npy, ReadsBothOrdersAndSingleValues) {
  expect_values(npy(header("<i4", "(2, 3)"), raw<std::int32_t>({1, 2, 3, 4, 5, 6})),
                {1, 2, 3, 4, 5, 6});
  expect_values(npy(header("<i4", "(2, 3)", true), raw<std::int32_t>({1, 4, 2, 5, 3, 6})),
                {1, 2, 3, 4, 5, 6});
  expect_values(npy(header("<f8", "()"), raw<double>({120})), {120});
  // Any key order, either quote, no last comma, Python 2's long numbers.
  expect_values(
      npy("{\"shape\":(2L,),\"fortran_order\":False,'descr':'<f8'}\n", raw<double>({1, 2})),
      {1, 2});
}

TEST(Npy, ReadsTexts) {
  const auto text = [](const std::string& bytes) {
    return single_text(parse_npy(bytes, "a.npy"), in_file("a.npy"));
  };
  EXPECT_EQ(text(npy(header("|S6", "()"), std::string("male\0\0", 6))), "male");
  EXPECT_EQ(text(npy(header("<U4", "()"), raw<std::uint32_t>({'m', 0xe4, 0x4e2d, 0x1f483}))),
            "m\u00e4\u4e2d\U0001f483");
  EXPECT_EQ(text(npy(header(">U2", "()"), raw<std::uint32_t>({'m', 'f'}, true))), "mf");
  EXPECT_EQ(text(npy_bytes("neutral")), "neutral");
  EXPECT_TRUE(
      contains(refusal([&] { text(npy(header("<f8", "()"), raw<double>({1}))); }), "a.npy"));
}

TEST(Npy, WritesWhatItReads) {
  std::vector<double> values(3 * 7);
  Random random(1);
  for (double& value : values) value = random.normal();
  const std::string bytes = npy_bytes(values.data(), {7, 3});
  EXPECT_EQ((bytes.size() - 8 * values.size()) % 64, 0u);  // numpy aligns the data
  expect_values(bytes, values);
  const double rate = 59.94;
  expect_values(npy_bytes(&rate, {}), {59.94});
}

TEST(Npy, RefusesWhatIsNotPlainDataNamingTheByte) {
  const auto says = [](const std::string& bytes, const std::string& part) {
    const std::string message = refusal([&] { parse_npy(bytes, "a.npy"); });
    EXPECT_TRUE(contains(message, "a.npy: byte ") && contains(message, part)) << message;
  };
  const std::string data = raw<double>({1, 2});
  says("", "does not begin with");
  says("\x93NUMPX", "does not begin with");
  says(npy(header("<f8", "(2,)"), data, 9), "version 9");
  says(npy(header("|O", "(2,)"), data), "Python objects");
  says(npy(header("<c16", "(1,)"), data), "complex");
  says(npy(header("|V16", "(1,)"), data), "structures");
  says(npy(header("<f16", "(1,)"), data), "<f16");
  says(npy(header("<f99999999999", "(1,)"), data), "expected numbers");
  says(npy("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2,), }", data),
       "structures");
  says(npy("{'descr': '<f8', 'shape': (2,), }", data), "fortran_order");
  says(npy("{'descr': '<f8', 'fortran_order': 1, 'shape': (2,), }", data), "True nor False");
  says(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), 'x': 1}", data), "unknown key");
  says(npy(header("<f8", "(3,)"), data), "needs 24 bytes");
  says(npy(header("<f8", "(-2,)"), data), "whole number");
  says(npy(header("<f8", "(4294967296, 4294967296, 16)"), data), "2^64");
  says(npy(header("<f8", "(99999999999999999999,)"), data), "absurd");
  says(npy(header("<f8", "(2,)") + "os.system()", data), "behind the closing brace");
  const std::string good = npy(header("<f8", "(2,)"), data, 2);
  for (std::size_t size = 0; size < good.size(); ++size) says(good.substr(0, size), "");
  std::string huge = good;
  huge[11] = '\x7f';  // a header of 2 GB
  says(huge, "header has");
}

TEST(Npy, SurvivesFlippedBits) {
  const std::string good = npy(header("<f8", "(2, 2)"), raw<double>({1, 2, 3, 4}), 1);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bytes = good;
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
    reads_or_refuses([&] { parse_npy(bytes, "a.npy"); }, "a.npy");
  }
}

}  // namespace
}  // namespace mocaplm::npy_test
