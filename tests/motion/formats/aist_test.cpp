#include "motion/formats/aist.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/formats/pickle_writer.h"
#include "motion/helpers.h"
#include "motion/skeleton.h"

namespace mocaplm::aist_test {
namespace {

struct Arrays {
  std::vector<double> poses, trans, scaling = {93.75};
  std::size_t frames = 3, columns = 72;
};

Arrays random_arrays() {
  Random random(21);
  Arrays arrays;
  for (int i = 0; i < 3 * 72; ++i) arrays.poses.push_back(random.uniform(-3, 3));
  for (int i = 0; i < 3 * 3; ++i) arrays.trans.push_back(random.uniform(-200, 200));
  return arrays;
}

std::string aist(const Arrays& arrays, const PickleStyle& style = {}) {
  PickleWriter writer(style);
  writer.begin_dictionary();
  writer.text("smpl_loss");
  writer.raw(std::string("G\0\0\0\0\0\0\0\0", 9));
  writer.text("smpl_poses");
  writer.array(arrays.poses, arrays.frames, arrays.columns);
  writer.text("smpl_scaling");
  writer.array(arrays.scaling, arrays.scaling.size(), 0);
  writer.text("smpl_trans");
  writer.array(arrays.trans, arrays.trans.size() / 3, 3);
  writer.end_dictionary();
  return writer.finish();
}

Clip read_at(const std::filesystem::path& path, UpAxis up,
             std::optional<double> fps = std::nullopt) {
  ReadOptions options;
  options.up = up;
  options.fps = fps;
  return read_clip(path, options);
}

TEST(Aist, GivesTheExpectedValues) {
  const auto files = expected_files("aist-pkl");
  if (files.empty()) GTEST_SKIP() << "no ../shared/data/formats/expected.json";
  for (const auto& [name, expected] : files)
    expect_clip(read_clip(shared_formats() / name), expected, name);
}

TEST(Aist, ReadsPosesExactlyAndMetres) {
  const Scratch scratch;
  const Arrays arrays = random_arrays();
  for (int protocol : {2, 3, 4, 5})
    for (int item_bytes : {4, 8}) {
      PickleStyle style;
      style.protocol = protocol;
      style.item_bytes = item_bytes;
      const auto path = scratch.put("gWA_sBM_cAll_d26_mWA2_ch03.pkl", aist(arrays, style));
      const Clip clip = read_clip(path);
      EXPECT_EQ(clip.fps, 60);
      EXPECT_EQ(clip.name, "gWA_sBM_cAll_d26_mWA2_ch03");
      for (std::size_t i = 0; i < arrays.poses.size(); ++i) {
        const double stored = item_bytes == 8
                                  ? arrays.poses[i]
                                  : static_cast<double>(static_cast<float>(arrays.poses[i]));
        ASSERT_EQ(clip.poses.data()[i], stored);
      }
      for (std::size_t i = 0; i < arrays.trans.size(); ++i)
        ASSERT_NEAR(clip.trans.data()[i], arrays.trans[i] / 93.75, 1e-6);
      EXPECT_EQ(read_at(path, UpAxis::automatic, 30.0).fps, 30);
      const Eigen::RowVector3d rest = rest_joints().row(0);  // the pelvis is what is turned
      EXPECT_NEAR(read_at(path, UpAxis::z).trans(1, 1) + rest.y(), clip.trans(1, 2) + rest.z(),
                  1e-12);
    }
}

TEST(Aist, NamesWhatIsWrong) {
  const Scratch scratch;
  const auto says = [&](const std::string& bytes, const std::string& part) {
    const auto path = scratch.put("a.pkl", bytes);
    const std::string text = refusal([&] { read_clip(path); });
    EXPECT_TRUE(contains(text, path.string()) && contains(text, part)) << text;
  };
  const Arrays good = random_arrays();
  Arrays bad = good;
  bad.columns = 36;
  bad.frames = 6;
  says(aist(bad), "(6, 36)");
  bad = good;
  bad.trans.resize(6);
  says(aist(bad), "(2, 3)");
  for (double scaling : {0.0, -93.0, std::nan("")}) {
    bad = good;
    bad.scaling = {scaling};
    says(aist(bad), "smpl_scaling is");
  }
  bad.scaling = {93, 93};
  says(aist(bad), "single number");
  bad = good;
  bad.poses[2 * 72 + 3 * 15 + 1] = std::nan("");
  says(aist(bad), "frame 2, joint head");
  bad = good;
  bad.trans[4] = std::numeric_limits<double>::infinity();
  says(aist(bad), "frame 1");
  says("", "empty");
  says("\x80\x04}.", "no poses, smpl_poses");
  says("\x80\x04K\x05.", "it is a number");
  says("\x80\x04}\x8c\x0asmpl_posesNs.", "holds no motion");
  says("\x80\x04}\x8c\x05other\x5ds.", "other");
  // Made, but never filled.
  says("\x80\x02}X\x0a" + std::string("\0\0\0smpl_poses", 13) +
           "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nNN\x87Rs.",
       "numpy array");
}

TEST(Aist, SurvivesCutsAndFlippedBits) {
  const Scratch scratch;
  std::vector<std::string> files = {aist(random_arrays())};
  for (const char* name : {"salsa_01.p2.pkl", "variant_float32.p4.pkl"})
    if (std::filesystem::exists(shared_formats() / name))
      files.push_back(read_file(shared_formats() / name));
  for (const std::string& good : files) {
    const auto check = [&](const std::string& bytes) {
      const auto path = scratch.put("a.pkl", bytes);
      return reads_or_refuses([&] { read_clip(path); }, path.string());
    };
    ASSERT_TRUE(check(good));
    const std::size_t step = std::max<std::size_t>(1, good.size() / 300);
    for (std::size_t size = 0; size < good.size(); size += step)
      EXPECT_FALSE(check(good.substr(0, size))) << size;
    Random random(22);
    for (int i = 0; i < 400; ++i) {
      std::string bytes = good;
      const std::size_t at = random.below(i % 2 == 0 ? bytes.size() : 400);
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.below(8));
      check(bytes);
    }
  }
}

TEST(AistLabels, ComeFromTheName) {
  const Labels expected = {{"genre", "waack"},
                           {"situation", "basic"},
                           {"dancer", "d26"},
                           {"music", "mWA2"},
                           {"choreography", "ch03"}};
  EXPECT_EQ(aist_labels("gWA_sBM_cAll_d26_mWA2_ch03"), expected);
  const std::vector<std::pair<std::string, std::string>> genres = {
      {"BR", "break"},       {"PO", "pop"},        {"LO", "lock"},  {"MH", "middle-hip-hop"},
      {"LH", "la-hip-hop"},  {"HO", "house"},      {"WA", "waack"}, {"KR", "krump"},
      {"JS", "street-jazz"}, {"JB", "ballet-jazz"}};
  for (const auto& [code, genre] : genres) {
    const auto labels = aist_labels("g" + code + "_sFM_cAll_d01_m" + code + "5_ch21");
    ASSERT_TRUE(labels);
    EXPECT_EQ(labels->at("genre"), genre);
    EXPECT_EQ(labels->at("situation"), "advanced");
  }
  for (const char* other :
       {"", "salsa_01", "gXX_sBM_cAll_d26_mWA2_ch03", "gWA_sBM_cAll_d26_mWA2_ch03.p4",
        "gWA_sXM_cAll_d26_mWA2_ch03", "gWA_sBM_cAll_d26_mWA2"})
    EXPECT_FALSE(aist_labels(other)) << other;
  EXPECT_FALSE(aist_labels(std::string(100000, 'g')));
}

TEST(Aist, PiecesAndOtherCamerasAreTheSameDance) {
  const std::string whole = "gBR_sBM_cAll_d04_mBR0_ch02";
  const auto labels = aist_labels(whole);
  ASSERT_TRUE(labels);
  for (const char* piece :
       {"gBR_sBM_cAll_d04_mBR0_ch02", "gBR_sBM_c01_d04_mBR0_ch02", "gBR_sBM_c09_d04_mBR0_ch02_seg1",
        "gBR_sBM_cAll_d04_mBR0_ch02_slice0", "gBR_sBM_c01_d04_mBR0_ch02_seg12_slice3",
        "gBR_sBM_cAll_d04_mBR0_ch02_slice3_seg12", "gBR_sBM_cAll_d04_mBR0_ch02_c05_slice1",
        "gBR_sBM_cAll_d04_mBR0_ch02_slice_7"}) {
    const auto name = parse_aist_name(piece);
    ASSERT_TRUE(name) << piece;
    EXPECT_EQ(name->labels, *labels) << piece;
    EXPECT_EQ(name->dance, whole) << piece;
  }
  EXPECT_NE(parse_aist_name("gBR_sBM_c01_d04_mBR0_ch03_seg1")->dance, whole);
  for (const char* other :
       {"gBR_sBM_c01_d04_mBR0_ch02_seg", "gBR_sBM_c01_d04_mBR0_ch02_segment1",
        "gBR_sBM_c1_d04_mBR0_ch02", "gBR_sBM_c01_d04_mBR0_ch02_", "gBR_sBM_c01_d04_mBR0_ch02_1"})
    EXPECT_FALSE(parse_aist_name(other)) << other;
}

}  // namespace
}  // namespace mocaplm::aist_test
