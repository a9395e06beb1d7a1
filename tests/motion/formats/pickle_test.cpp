#include "motion/formats/pickle.h"

#include <gtest/gtest.h>

#include "motion/formats/helpers.h"
#include "motion/formats/pickle_writer.h"

namespace mocaplm::pickle_test {
namespace {

using namespace std::string_literals;

// Arrays as every numpy and protocol writes them.
std::vector<PickleStyle> styles() {
  std::vector<PickleStyle> all;
  for (int protocol : {2, 3, 4, 5})
    for (bool modern : {false, true})
      for (bool big_endian : {false, true})
        for (bool fortran : {false, true}) {
          PickleStyle style;
          style.protocol = protocol;
          style.module = modern ? "numpy._core" : "numpy.core";
          style.big_endian = big_endian;
          style.fortran = fortran;
          all.push_back(style);
        }
  return all;
}

TEST(Pickle, ReadsArraysOfEveryProtocolAndNumpy) {
  const std::vector<double> values = {1, 2.5, -3e200, 4, 5, 6};
  for (const PickleStyle& style : styles()) {
    PickleWriter writer(style);
    writer.begin_dictionary();
    writer.text("a");
    writer.array(values, 2, 3);
    writer.text("n");
    writer.op("K", 7);
    writer.end_dictionary();
    const std::string bytes = writer.finish();
    const Pickle pickle(bytes, "a.pkl");
    ASSERT_NE(pickle.find("a"), nullptr);
    const NumpyArray& array = pickle.find("a")->array;
    ASSERT_EQ(shape_text(array), "(2, 3)");
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(array.at(i / 3, i % 3), values[i]);
    EXPECT_EQ(pickle.find("n")->number, 7);
    EXPECT_EQ(pickle.find("x"), nullptr);
    EXPECT_EQ(pickle.keys(), (std::vector<std::string>{"a", "n"}));
  }
}

TEST(Pickle, ReadsPlainObjects) {
  // (3, -2, 70000, 1.5, None, True, [b"x", "y"], {"k": ()})
  const std::string bytes =
      "\x80\x04(K\x03J\xfe\xff\xff\xff\x8a\x03\x70\x11\x01G\x3f\xf8\0\0\0\0\0\0N\x88]("
      "C\x01x\x8c\x01ye}"
      "X\x01\0\0\0k)st."s;
  const Pickle pickle(bytes, "a.pkl");
  const auto& items = pickle.root().items;
  ASSERT_EQ(items.size(), 8u);
  EXPECT_EQ(items[0]->number, 3);
  EXPECT_EQ(items[1]->number, -2);
  EXPECT_EQ(items[2]->number, 70000);
  EXPECT_EQ(items[3]->number, 1.5);
  EXPECT_EQ(items[4]->kind, PickleKind::none);
  EXPECT_EQ(items[5]->number, 1);
  EXPECT_EQ(items[6]->items[1]->text, "y");
  EXPECT_EQ(items[7]->items[0]->text, "k");
}

std::string message(const std::string& bytes) {
  return refusal([&] { Pickle(bytes, "a.pkl"); });
}

TEST(Pickle, RefusesEverythingThatCouldRunNamingItAndItsByte) {
  const auto says = [](const std::string& bytes, const std::string& part) {
    const std::string text = message(bytes);
    EXPECT_TRUE(contains(text, "a.pkl: byte ") && contains(text, part)) << text;
  };
  says(
      "\x80\x02"
      "cos\nsystem\nX\x02\0\0\0id\x85R.",
      "byte 2: refuses the global os.system");
  says(
      "\x80\x04\x8c\x08"
      "builtins\x8c\x04"
      "eval\x93.",
      "byte 18: refuses the global builtins.eval");
  says(
      "\x80\x02"
      "cnumpy.core.multiarray\nfromfile\n.",
      "numpy.core.multiarray.fromfile");
  says("\x80\x04\x8c\x01\x1b\x8c\x01\n\x93.",
       "global ?.?");  // no control characters on the terminal
  for (const auto& [opcode, name] :
       std::vector<std::pair<std::string, std::string>>{{"i", "INST"},
                                                        {"o", "OBJ"},
                                                        {"\x92", "NEWOBJ_EX"},
                                                        {"\x82", "EXT1"},
                                                        {"P", "PERSID"},
                                                        {"Q", "BINPERSID"},
                                                        {"2", "DUP"},
                                                        {"\x8b", "LONG4"},
                                                        {"\xff", "0xff"},
                                                        {"\x97", "NEXT_BUFFER"}})
    says("\x80\x04N" + opcode, "byte 3: refuses the pickle opcode " + name);
  says("\x80\x02NNR.", "calls None");
  says(
      "\x80\x02"
      "cnumpy\nndarray\n)R.",
      "numpy.ndarray");
  says(
      "\x80\x02"
      "cnumpy\ndtype\nX\x01\0\0\0O\x89\x88\x87R.",
      "");
  says(
      "\x80\x02"
      "cnumpy\ndtype\nX\x02\0\0\0c8\x89\x88\x87R."s,
      "expected numbers");
  says("\x80\x04N)\x81", "byte 4: makes an object of None");
  says(
      "\x80\x02"
      "cnumpy\nndarray\n)\x81",
      "makes an object of numpy.ndarray");
  says(
      "\x80\x02}N"
      "b.",
      "sets the state of a dictionary");
}

TEST(Pickle, RefusesMachinesThatDoNotAddUp) {
  const auto says = [](const std::string& bytes, const std::string& part) {
    const std::string text = message(bytes);
    EXPECT_TRUE(contains(text, part)) << text;
  };
  says("", "empty");
  says("(dp0", "protocol 2 or newer");
  says("\x80\x01N.", "protocol 1");
  says("\x80\x09N.", "protocol 9");
  says("\x80\x02.", "0 objects");
  says("\x80\x02NN.", "2 objects");
  says("\x80\x02(N.", "stops with");
  says("\x80\x02t.", "mark");
  says("\x80\x02N\x86.", "empty stack");
  says("\x80\x02(\x85.", "empty stack");
  says("\x80\x02h\x05.", "object 5");
  says("\x80\x02NNa.", "appends to None");
  says("\x80\x02}(Nu.", "without a value");
  says("\x80\x02X\xff\xff\xff\x7fhello"s, "truncated");
  says("\x80\x04\x8e\xff\xff\xff\xff\xff\xff\xff\xff", "truncated");
  says("\x80\x04\x95\xff\xff\xff\xff\xff\xff\xff\xff", "frame");
  says("\x80\x02\x8a\x09", "9 bytes");
  says("\x80\x02" + std::string(20000, '('), "10000 deep");
  says("\x80\x02" + std::string(20000, 'N'), "on the stack");
  std::string many = "\x80\x02]";
  for (int i = 0; i < 1100000; ++i) many += "Na";
  says(many + ".", "more than 1000000");
  std::string memo = "\x80\x04N";
  says(memo + std::string(1100000, '\x94') + ".", "remembered");
}

TEST(Pickle, RefusesDecodingTheSameTextAgainAndAgain) {
  // x = a text of 1000 letters; then _codecs.encode(x, "latin1") 50 times.
  std::string bytes = "\x80\x02(c_codecs\nencode\nq";
  bytes += '\0';
  bytes += "X\xe8\x03\0\0"s + std::string(1000, 'a') + "q\x01";
  bytes += "X\x06\0\0\0latin1q\x02"s;
  for (int i = 0; i < 50; ++i) bytes += "h\0h\x01h\x02\x86R"s;
  EXPECT_TRUE(contains(message(bytes + "t."), "decodes more"));
}

TEST(Pickle, HoldsObjectsThatContainThemselves) {
  const Pickle pickle("\x80\x02]q\0h\0a."s, "a.pkl");
  EXPECT_EQ(pickle.root().items[0], &pickle.root());
}

// Newer numpy adds the order of axes to protocol 5's call.
TEST(Pickle, ReadsBuffersWithAnOrderOfAxes) {
  const auto pickle_with = [](const std::string& order, const std::string& axes) {
    PickleWriter writer({5, "numpy._core", false, false, 8});
    writer.global("numpy._core.numeric", "_frombuffer");
    writer.raw("(");
    writer.bytes(std::string(48, '\0'));
    writer.dtype();
    writer.raw("K\x02K\x03\x86");
    writer.text(order);
    writer.raw(axes + "tR");
    return writer.finish();
  };
  const std::string good = pickle_with("C", "N");
  EXPECT_EQ(shape_text(Pickle(good, "a.pkl").root().array), "(2, 3)");
  EXPECT_TRUE(contains(message(pickle_with("K", "N")), "order"));
  EXPECT_TRUE(contains(message(pickle_with("K", "K\x01K\x02\x86")), "5 arguments"));
}

TEST(Pickle, RefusesArraysThatDoNotMatchTheirData) {
  PickleStyle style;
  PickleWriter writer(style);
  writer.array({1, 2, 3, 4}, 2, 3);  // says six, brings four
  const std::string text = message(writer.finish());
  EXPECT_TRUE(contains(text, "needs 48 bytes") && contains(text, "32")) << text;
}

TEST(Pickle, SurvivesCutsAndFlippedBits) {
  for (const PickleStyle& style : styles()) {
    PickleWriter writer(style);
    writer.begin_dictionary();
    writer.text("a");
    writer.array({1, 2, 3, 4}, 2, 2);
    writer.end_dictionary();
    const std::string good = writer.finish();
    for (std::size_t size = 0; size < good.size(); ++size)
      EXPECT_FALSE(reads_or_refuses([&] { Pickle(good.substr(0, size), "a.pkl"); }, "a.pkl"));
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bytes = good;
      bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
      reads_or_refuses([&] { Pickle(bytes, "a.pkl"); }, "a.pkl");
    }
  }
}

}  // namespace
}  // namespace mocaplm::pickle_test
