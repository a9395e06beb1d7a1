#include "motion/formats/npz.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <cmath>
#include <limits>

#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/formats/npy.h"
#include "motion/formats/zip_file.h"
#include "motion/helpers.h"
#include "motion/rotation.h"
#include "motion/skeleton.h"

namespace mocaplm::npz_test {
namespace {

using Entries = std::vector<std::pair<std::string, std::string>>;

// (rows, columns) random angles as a .npy entry.
std::string random_npy(Random& random, std::size_t rows, std::size_t columns) {
  std::vector<double> values(rows * columns);
  for (double& value : values) value = random.uniform(-1, 1);
  return npy_bytes(values.data(), {rows, columns});
}

Entries amass(std::size_t columns, double fps, const std::string& rate_key = "mocap_framerate") {
  Random random(columns);
  return {{"poses.npy", random_npy(random, 9, columns)},
          {"trans.npy", random_npy(random, 9, 3)},
          {rate_key + ".npy", npy_bytes(&fps, {})}};
}

Clip read_entries(const Scratch& scratch, const Entries& entries, UpAxis up = UpAxis::automatic) {
  write_zip(scratch / "a.npz", entries);
  return read_npz(scratch / "a.npz", up);
}

TEST(Npz, GivesTheExpectedValues) {
  const auto files = expected_files("amass-npz");
  if (files.empty()) GTEST_SKIP() << "no ../shared/data/formats/expected.json";
  for (const auto& [name, expected] : files) {
    const Clip clip = read_clip(shared_formats() / name);
    if (expected.value("up", "") != "Z") {
      expect_clip(clip, expected, name);
      continue;
    }
    // This file's writer turned `trans` alone, as if it were the pelvis. SMPL's pelvis lies at
    // trans + J, and what is turned is that: the same motion, R J - J aside.
    const Clip same = read_npz(shared_formats() / "salsa_01.npz");
    const Eigen::RowVector3d rest = rest_joints().row(0);
    const Eigen::RowVector3d aside(0, rest.z() - rest.y(), -rest.y() - rest.z());
    EXPECT_LT((clip.poses - same.poses).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((clip.trans - (same.trans.rowwise() + aside)).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Npz, ComesBackExactlyAndWithTheSameBytes) {
  const Scratch scratch;
  Random random(5);
  for (double fps : {20.0, 59.94, 120.0}) {
    const Clip clip = random_clip(random, 31, fps, 6.0);
    write_clip(scratch / "dance.npz", clip);
    const std::string bytes = read_file(scratch / "dance.npz");
    const Clip back = read_clip(scratch / "dance.npz");
    EXPECT_TRUE(back.poses == clip.poses && back.trans == clip.trans);
    EXPECT_EQ(back.fps, fps);
    EXPECT_EQ(back.name, "dance");
    write_clip(scratch / "again.npz", back);
    EXPECT_EQ(read_file(scratch / "again.npz"), bytes);
  }
}

TEST(Npz, WritesWhatAmassToolsRead) {
  const Scratch scratch;
  Random random(6);
  write_npz(scratch / "a.npz", random_clip(random, 4, 60));
  const ZipReader zip(scratch / "a.npz");
  const std::vector<std::string> expected = {"poses.npy",  "trans.npy",           "betas.npy",
                                             "gender.npy", "mocap_framerate.npy", "up_axis.npy"};
  EXPECT_EQ(zip.names(), expected);
  const std::string gender = zip.read("gender.npy"), betas = zip.read("betas.npy");
  EXPECT_EQ(single_text(parse_npy(gender, "gender"), in_file("gender")), "neutral");
  EXPECT_EQ(shape_text(parse_npy(betas, "betas")), "(16,)");
}

TEST(Npz, ReadsEveryLayoutOfAmass) {
  const Scratch scratch;
  for (std::size_t columns : {72, 156, 165, 66}) {
    const Entries entries = amass(columns, 120);
    const NumpyArray poses = parse_npy(entries[0].second, "poses");
    const NumpyArray trans = parse_npy(entries[1].second, "trans");
    const Clip y_up = read_entries(scratch, entries, UpAxis::y);
    const Eigen::Index body = columns == 72 ? 72 : 66;
    for (Eigen::Index t = 0; t < 9; ++t) {
      for (Eigen::Index c = 0; c < 72; ++c)
        ASSERT_EQ(y_up.poses(t, c), c < body ? poses.at(t, c) : 0.0);
      for (Eigen::Index c = 0; c < 3; ++c) ASSERT_EQ(y_up.trans(t, c), trans.at(t, c));
    }
    // Z up: the root is turned, the rest stays.
    const Clip z_up = read_entries(scratch, entries, UpAxis::z);
    const Eigen::Matrix3d turn = matrix_from_axis_angle({-std::acos(0.0), 0, 0});
    for (Eigen::Index t = 0; t < 9; ++t) {
      const auto root = [&](const Clip& clip) {
        return matrix_from_axis_angle(clip.poses.row(t).segment<3>(0).transpose());
      };
      ASSERT_LT((root(z_up) - turn * root(y_up)).norm(), 1e-12);
      const Eigen::Vector3d rest = rest_joints().row(0).transpose();
      const Eigen::Vector3d pelvis = y_up.trans.row(t).transpose() + rest;
      ASSERT_LT((z_up.trans.row(t).transpose() + rest - turn * pelvis).norm(), 1e-12);
    }
    EXPECT_TRUE(z_up.poses.rightCols(69) == y_up.poses.rightCols(69));
    if (columns == 66) continue;
    EXPECT_TRUE(read_entries(scratch, entries).poses == (columns == 72 ? y_up : z_up).poses);
  }
  EXPECT_TRUE(contains(refusal([&] { read_entries(scratch, amass(66, 120)); }), "--up"));
}

TEST(Npz, ReadsSmplxFilesWithoutPoses) {
  const Scratch scratch;
  Random random(8);
  Entries entries = amass(72, 60, "mocap_frame_rate");
  entries[0] = {"root_orient.npy", random_npy(random, 9, 3)};
  entries.push_back({"pose_body.npy", random_npy(random, 9, 63)});
  const Clip clip = read_entries(scratch, entries, UpAxis::y);
  EXPECT_EQ(clip.poses(4, 2), parse_npy(entries[0].second, "").at(4, 2));
  EXPECT_EQ(clip.poses(4, 65), parse_npy(entries[3].second, "").at(4, 62));
  EXPECT_TRUE(read_entries(scratch, entries).poses ==
              read_entries(scratch, entries, UpAxis::z).poses);
}

TEST(Npz, RoundsRatesThatAreNearlyWhole) {
  const Scratch scratch;
  EXPECT_EQ(read_entries(scratch, amass(72, 120.00004577636719)).fps, 120);
  EXPECT_EQ(read_entries(scratch, amass(72, 99.9996, "mocap_frame_rate")).fps, 100);
  EXPECT_EQ(read_entries(scratch, amass(72, 29.97)).fps, 29.97);
  write_zip(scratch / "b.npz", {amass(72, 1)[0], amass(72, 1)[1]});
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch / "b.npz"); }), "--fps"));
  EXPECT_EQ(read_npz(scratch / "b.npz", UpAxis::automatic, 25.0).fps, 25);
  ReadOptions options;
  options.fps = -1;
  EXPECT_THROW(read_clip(scratch / "b.npz", options), UsageError);
}

TEST(Npz, NamesWhatIsWrong) {
  const Scratch scratch;
  const auto says = [&](const Entries& entries, const std::string& part) {
    const std::string message = refusal([&] { read_entries(scratch, entries); });
    EXPECT_TRUE(contains(message, "a.npz") && contains(message, part)) << message;
  };
  const Entries good = amass(72, 60);
  Random random(9);
  says({{"betas.npy", "x"}, {"gender.npy", "x"}}, "holds no motion");
  says({good[0], good[2]}, "no trans");
  says({{"poses.npy", random_npy(random, 9, 71)}, good[1], good[2]}, "(9, 71)");
  says({{"poses.npy", random_npy(random, 8, 72)}, good[1], good[2]}, "8 frames");
  says({{"poses.npy", npy_bytes(nullptr, {0, 72})}, good[1], good[2]}, "no frames");
  says({{"poses.npy", npy_bytes("nothing")}, good[1], good[2]}, "floating-point");
  says({{"poses.npy", good[0].second.substr(0, 500)}, good[1], good[2]}, "poses.npy: byte 128");
  for (double fps : {0.0, -60.0, std::nan(""), 1e9}) says(amass(72, fps), "frame rate");
  says({good[0], good[1], {"mocap_framerate.npy", random_npy(random, 2, 1)}}, "single number");
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e30}) {
    std::vector<double> values(9 * 72, 0.5);
    values[4 * 72 + 13] = bad;
    says({{"poses.npy", npy_bytes(values.data(), {9, 72})}, good[1], good[2]},
         "frame 4, joint left_knee");
  }
}

TEST(Npz, RefusesFilesThatAreNoArchives) {
  const Scratch scratch;
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch / "none.npz"); }), "no such file"));
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch.put("e.npz", "")); }), "PK"));
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch.put("t.npz", "hello")); }), "PK"));
  EXPECT_TRUE(
      contains(refusal([&] { read_npz(scratch.put("p.npz", "PK\3\4 hello")); }), "truncated"));
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch.put("e.npz", "")); }), "is empty"));
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch.put("x.npz", "HIERARCHY\n")); }), "BVH"));
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch.put("x.pkl", "PK\3\4")); }), ".npz"));
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch.put("x.txt", "PK\3\4")); }), "rename"));
  EXPECT_TRUE(contains(refusal([&] { read_clip(scratch / ""); }), "folder"));
  Random random(1);
  EXPECT_THROW(write_clip(scratch / "x.pkl", random_clip(random, 2, 30)), UsageError);
  EXPECT_THROW(write_clip(scratch / "w.npz", Clip{}), DataError);
  EXPECT_FALSE(std::filesystem::exists(scratch / "w.npz"));
}

// An archive with a deflated entry of `zeros` zero bytes.
std::string bomb(const Scratch& scratch, std::size_t zeros) {
  int code = 0;
  zip_t* zip = zip_open((scratch / "bomb.zip").c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
  const std::string bytes(zeros, '\0');
  const auto index = zip_file_add(
      zip, "poses.npy", zip_source_buffer(zip, bytes.data(), bytes.size(), 0), ZIP_FL_OVERWRITE);
  zip_set_file_compression(zip, static_cast<zip_uint64_t>(index), ZIP_CM_DEFLATE, 9);
  zip_close(zip);
  return read_file(scratch / "bomb.zip");
}

TEST(Npz, RefusesBombsAndLies) {
  const Scratch scratch;
  const std::string big = bomb(scratch, 20u << 20);
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch.put("b.npz", big)); }), "zip bomb"));
  // The central directory claims 4 GB for what is 1 MB.
  std::string lie = bomb(scratch, 1u << 20);
  const std::size_t central = lie.rfind("PK\1\2");
  for (std::size_t i = 24; i < 28; ++i) lie[central + i] = i == 27 ? '\xef' : '\xff';
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch.put("l.npz", lie)); }), "cannot be"));
  lie[central + 26] = 0x08;  // half of what is there: found while reading
  lie[central + 24] = lie[central + 25] = lie[central + 27] = 0;
  EXPECT_TRUE(contains(refusal([&] { read_npz(scratch.put("l.npz", lie)); }), "poses.npy"));
}

// What a real, deflated file turns into when it is cut or bits flip: refused, or the same motion.
void abuse(const std::string& good, const Scratch& scratch) {
  const Clip clip = read_npz(scratch.put("good.npz", good));
  const auto check = [&](const std::string& bytes) {
    const auto path = scratch.put("broken.npz", bytes);
    reads_or_refuses(
        [&] {
          const Clip read = read_npz(path);
          EXPECT_TRUE(read.poses == clip.poses);
        },
        path.string());
  };
  const std::size_t step = std::max<std::size_t>(1, good.size() / 1500);
  for (std::size_t size = 0; size < good.size(); size += step) check(good.substr(0, size));
  Random random(3);
  for (int i = 0; i < 1500; ++i) {
    std::string bytes = good;
    const int flips = 1 + static_cast<int>(random.below(3));
    for (int k = 0; k < flips; ++k) {
      // Half of them in the directory at the end, where the sizes are.
      const std::size_t end =
          i % 2 == 0 ? 0 : good.size() - std::min<std::size_t>(good.size(), 500);
      const std::size_t at = end + random.below(good.size() - end);
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.below(8));
    }
    check(bytes);
  }
}

TEST(Npz, SurvivesCutsAndFlippedBits) {
  const Scratch scratch;
  Random random(4);
  write_npz(scratch / "made.npz", random_clip(random, 3, 60));
  abuse(read_file(scratch / "made.npz"), scratch);
}

TEST(Npz, SurvivesCutsAndFlippedBitsOfARealFile) {
  const auto path = shared_formats() / "variant_deflate.npz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  abuse(read_file(path), Scratch());
}

}  // namespace
}  // namespace mocaplm::npz_test
