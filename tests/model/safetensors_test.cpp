// The safetensors format against files built by hand, and damaged in every way.
#include "model/safetensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "common/files.h"
#include "common/random.h"
#include "common/temporary_folder.h"
#include "support/refusal.h"

namespace mocaplm::safetensors_test {

namespace {

std::string length_bytes(std::uint64_t length) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(length >> (8 * i) & 0xFF);
  return bytes;
}

std::string floats(const std::vector<float>& values) {
  std::string bytes(4 * values.size(), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string built(const std::string& header, const std::string& data) {
  return length_bytes(header.size()) + header + data;
}

TensorMap random_tensors(Random& random) {
  TensorMap tensors;
  for (const char* name : {"b", "a.weight", "block.10.x", "block.2.x", "empty", "scalar"}) {
    NamedTensor& tensor = tensors[name];
    if (std::string(name) != "scalar")
      for (std::uint64_t i = 0; i < 1 + random.below(3); ++i)
        tensor.shape.push_back(
            std::string(name) == "empty" ? 0 : static_cast<std::int64_t>(1 + random.below(5)));
    for (std::int64_t i = 0; i < tensor.size(); ++i)
      tensor.values.push_back(static_cast<float>(random.normal() * 1e3));
  }
  return tensors;
}

class Safetensors : public testing::Test {
 protected:
  TensorMap read(const std::string& bytes) {
    put(file_, bytes);
    return read_safetensors(file_);
  }
  std::string refused(const std::string& bytes) {
    const std::string message = refusal<DataError>([&] { read(bytes); });
    EXPECT_TRUE(contains(message, "w.safetensors")) << message;
    return message;
  }

  TemporaryFolder folder_;
  std::string file_ = (folder_ / "w.safetensors").string();
};

TEST_F(Safetensors, WhatIsWrittenIsReadBackBitForBit) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const TensorMap tensors = random_tensors(random);
    write_safetensors(file_, tensors);
    const TensorMap back = read_safetensors(file_);
    ASSERT_EQ(back.size(), tensors.size());
    for (const auto& [name, tensor] : tensors) {
      EXPECT_EQ(back.at(name).shape, tensor.shape) << name;
      EXPECT_EQ(back.at(name).values, tensor.values) << name;
    }
  }
}

TEST_F(Safetensors, WritesTheLayoutOfTheSpecification) {
  write_safetensors(file_, {{"x", {{2}, {1.5f, -2.f}}}});
  const std::string bytes = read_file(file_);
  std::string header = R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})";
  header.resize((header.size() + 7) / 8 * 8, ' ');
  EXPECT_EQ(bytes, built(header, floats({1.5f, -2.f})));
}

TEST_F(Safetensors, ReadsFilesOfOthersWithMetadataAndAnyOrder) {
  const TensorMap tensors = read(built(R"({"__metadata__": {"format": "pt"},
                "late": {"dtype": "F32", "shape": [1, 2], "data_offsets": [4, 12]},
                "early": {"data_offsets": [0, 4], "shape": [], "dtype": "F32"}})",
                                       floats({7, 8, 9})));
  EXPECT_EQ(tensors.at("early").values, std::vector<float>({7}));
  EXPECT_EQ(tensors.at("late").values, std::vector<float>({8, 9}));
  EXPECT_EQ(tensors.at("late").shape, std::vector<std::int64_t>({1, 2}));
}

TEST_F(Safetensors, EveryTruncationIsRefusedByName) {
  write_safetensors(file_, {{"x", {{3}, {1, 2, 3}}}, {"y", {{2, 2}, {1, 2, 3, 4}}}});
  const std::string bytes = read_file(file_);
  for (std::size_t size = 0; size < bytes.size(); ++size) refused(bytes.substr(0, size));
  EXPECT_TRUE(contains(refused(bytes.substr(0, bytes.size() - 5)), "y"));
  EXPECT_TRUE(contains(refused(bytes + "z"), "1 bytes after the last tensor"));
}

TEST_F(Safetensors, InconsistentHeadersAreRefused) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"dtype": "F16", "shape": [2], "data_offsets": [0, 8]})", "dtype"},
      {R"({"shape": [2], "data_offsets": [0, 8]})", "dtype"},
      {R"({"dtype": "F32", "shape": [3], "data_offsets": [0, 8]})", "data_offsets"},
      {R"({"dtype": "F32", "shape": [2], "data_offsets": [8, 0]})", "data_offsets"},
      {R"({"dtype": "F32", "shape": [1], "data_offsets": [4, 8]})", "data_offsets"},
      {R"({"dtype": "F32", "shape": [2], "data_offsets": [0]})", "data_offsets"},
      {R"({"dtype": "F32", "shape": [2], "data_offsets": [0, 8.0]})", "data_offsets"},
      {R"({"dtype": "F32", "shape": [-2], "data_offsets": [0, 8]})", "shape"},
      {R"({"dtype": "F32", "shape": 2, "data_offsets": [0, 8]})", "shape"},
      {R"({"dtype": "F32", "shape": null, "data_offsets": [0, 4]})", "shape"},
      {R"({"dtype": "F32", "shape": [4294967296, 4294967296], "data_offsets": [0, 8]})", "shape"},
      {R"({"dtype": "F32", "shape": [7, 7, 7], "data_offsets": [0, 8]})", "shape"},
      {R"({"dtype": "F32", "shape": [2], "data_offsets": [0, 8], "more": 1})", "more"},
      {R"([1, 2])", "object"},
  };
  for (const auto& [entry, said] : cases)
    EXPECT_TRUE(contains(refused(built("{\"x\": " + entry + "}", floats({1, 2}))), said)) << entry;
  refused(built("[]", ""));
  refused(built("{\"x\": ", ""));
  refused(length_bytes(std::uint64_t{1} << 63) + "{}");
  // Two tensors that share bytes.
  refused(built(R"({"x": {"dtype": "F32", "shape": [2], "data_offsets": [0, 8]},
                    "y": {"dtype": "F32", "shape": [1], "data_offsets": [4, 8]}})",
                floats({1, 2})));
}

TEST_F(Safetensors, ValuesThatAreNotFiniteAreRefusedAtTheirByte) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
    write_safetensors(file_, {{"x", {{3}, {1, bad, 3}}}});
    const std::string bytes = read_file(file_);
    const std::string message = refused(bytes);
    EXPECT_TRUE(contains(message, "byte " + std::to_string(bytes.size() - 8))) << message;
  }
}

TEST_F(Safetensors, RandomDamageIsReadOrRefusedNeverACrash) {
  Random random(2);
  write_safetensors(file_, random_tensors(random));
  const std::string bytes = read_file(file_);
  int refusals = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = bytes;
    for (std::uint64_t i = 0; i < 1 + random.below(3); ++i)
      damaged[random.below(round % 2 == 0 ? 400 : bytes.size())] =
          static_cast<char>(random.below(256));
    refusals += reads_or_refuses([&] { read(damaged); }, "w.safetensors") ? 0 : 1;
  }
  EXPECT_GT(refusals, 500);
}

TEST_F(Safetensors, AMissingFileIsADataError) {
  EXPECT_THROW(read_safetensors(folder_ / "absent"), DataError);
  EXPECT_THROW(read_safetensors(folder_.path()), DataError);
}

}  // namespace

}  // namespace mocaplm::safetensors_test
