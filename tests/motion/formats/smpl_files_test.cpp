// The dictionaries of estimators and generators: keys, forms of rotations, people, ways to pickle.
#include "motion/formats/smpl_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "motion/formats/helpers.h"
#include "motion/formats/smpl_files.h"
#include "motion/formats/zip_file.h"

namespace mocaplm::smpl_files_test {
namespace {

using namespace std::string_literals;

std::filesystem::path shared_case(const std::string& name) {
  return std::filesystem::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "cases" / name;
}

bool remarked(const ReadMotion& motion, const std::string& kind) {
  for (const Remark& remark : motion.report.remarks)
    if (remark.kind == kind) return true;
  return false;
}

TEST(SmplFiles, FilesOfOtherProgramsStandWhereTheyShould) {
  for (const char* name :
       {"smpl-files-of-other-tools/edge_test.pkl", "smpl-files-of-other-tools/wham_output.pkl",
        "smpl-files-of-other-tools/gvhmr.npz", "smplx-y-up/beat2.npz"}) {
    const auto path = shared_case(name);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const JointPositions joints = joint_positions(read_clip(path), 0);
    EXPECT_LT((joints.row(0) - Eigen::RowVector3d(0, 0.95, 0)).norm(), 1e-3) << name;
    EXPECT_GT(joints(15, 1), 1.4) << name;
  }
}

TEST(SmplFiles, RotationsComeInEveryForm) {
  const Scratch scratch;
  const Clip walk = walker();
  const auto n = static_cast<std::size_t>(walk.frames());
  const auto root = values(walk, 0, 3), trans = translations(walk);
  const std::vector<Entries> files = {
      {entry("global_orient", root, {n, 3}), entry("body_pose", values(walk, 3, 63), {n, 63}),
       entry("transl", trans, {n, 3})},
      {entry("global_orient", root, {n, 1, 3}), entry("body_pose", values(walk, 3, 69), {n, 69}),
       entry("transl", trans, {n, 1, 3})},
      {entry("global_orient", root, {1, n, 3}),
       entry("body_pose", values(walk, 3, 69), {1, n, 23, 3}), entry("transl", trans, {1, n, 3})},
      {entry("global_orient", matrices(walk, 0, 1), {n, 1, 3, 3}),
       entry("body_pose", matrices(walk, 1, 23), {n, 23, 3, 3}), entry("transl", trans, {n, 3})},
      {entry("global_orient", matrices(walk, 0, 1), {n, 3, 3}),
       entry("body_pose", matrices(walk, 1, 21), {n, 21, 3, 3}), entry("transl", trans, {n, 3})},
      {entry("pred_rotmat", matrices(walk, 0, 24), {n, 24, 3, 3}),
       entry("pred_trans", trans, {n, 1, 3})},
      {entry("poses", values(walk, 0, 72), {n, 24, 3}), entry("trans", trans, {n, 3}),
       entry("fps", {30}, {1})},
      {entry("poses", values(walk, 0, 66), {n, 22, 3}), entry("trans", trans, {n, 3}),
       entry("mocap_framerate", {30}, {})},
      {entry("smpl_poses", values(walk, 0, 72), {n, 24, 3}), entry("smpl_scaling", {1}, {1}),
       entry("smpl_trans", trans, {n, 3})},
      {entry("pose_world", values(walk, 0, 72), {n, 72}), entry("trans_world", trans, {n, 3}),
       entry("pose", values(walk, 0, 72), {n, 72}), entry("trans", trans, {n, 3})}};
  for (std::size_t i = 0; i < files.size(); ++i) {
    write_zip(scratch / "a.npz", files[i]);
    const std::vector<ReadMotion> motions = read_clips(scratch / "a.npz");
    ASSERT_EQ(motions.size(), 1u);
    EXPECT_EQ(motions[0].clip.name, "a");
    EXPECT_LT(apart(motions[0].clip, walk), 1e-6) << i;
    EXPECT_EQ(motions[0].clip.fps, i == 8 ? 60 : 30) << i;
    const bool says_rate = i == 6 || i == 7 || i == 8;
    EXPECT_EQ(remarked(motions[0], "no frame rate"), !says_rate) << i;
    ReadOptions options;
    options.fps = 25;
    EXPECT_EQ(read_clip(scratch / "a.npz", options).fps, 25);
  }
}

// EDGE's figure has its root at smpl_trans, in a world with Z up.
TEST(SmplFiles, EdgeHasNoScalingAndItsRootAtTheTranslation) {
  const Scratch scratch;
  const Clip walk = walker(), world = in_world(walk, UpAxis::z);
  const auto n = static_cast<std::size_t>(walk.frames());
  Clip moved = world;
  moved.trans.rowwise() += rest_joints().row(0);
  write_zip(scratch / "a.npz", {entry("smpl_poses", values(world, 0, 72), {n, 72}),
                                entry("smpl_trans", translations(moved), {n, 3})});
  EXPECT_LT(apart(read_clip(scratch / "a.npz"), walk), 1e-6);
}

// A pickled dictionary whose arrays and dictionaries are written one after another.
class Dictionary {
 public:
  explicit Dictionary(int protocol = 4) : writer_({protocol, "numpy.core", false, false, 8}) {
    writer_.begin_dictionary();
  }
  void key(const std::string& name) { writer_.text(name); }
  void key(int number) { writer_.op("K", static_cast<std::uint64_t>(number)); }
  void array(const std::vector<double>& data, std::size_t rows, std::size_t columns) {
    writer_.array(data, rows, columns);
  }
  PickleWriter& writer() { return writer_; }
  std::string finish() {
    writer_.end_dictionary();
    return writer_.finish();
  }

 private:
  PickleWriter writer_;
};

void add_wham(PickleWriter& writer, const Clip& clip) {
  const auto n = static_cast<std::size_t>(clip.frames());
  writer.begin_dictionary();
  writer.text("pose_world");
  writer.array(values(clip, 0, 72), n, 72);
  writer.text("trans_world");
  writer.array(translations(clip), n, 3);
  writer.text("frame_ids");
  writer.array(std::vector<double>(n, 1), n, 0);
  writer.end_dictionary();
}

TEST(SmplFiles, SeveralPeopleAreSeveralClips) {
  const Scratch scratch;
  const Clip one = walker(12), other = walker(7);
  for (int protocol : {2, 4, 5}) {
    Dictionary file(protocol);
    file.key(0);
    add_wham(file.writer(), one);
    file.key(13);
    add_wham(file.writer(), other);
    const auto path = scratch.put("dance.pkl", file.finish());
    const std::vector<ReadMotion> motions = read_clips(path);
    ASSERT_EQ(motions.size(), 2u);
    EXPECT_EQ(motions[0].clip.name, "dance_0");
    EXPECT_EQ(motions[1].clip.name, "dance_13");
    EXPECT_LT(apart(motions[0].clip, one), 1e-9);
    EXPECT_LT(apart(motions[1].clip, other), 1e-9);
    EXPECT_TRUE(remarked(motions[0], "frames left out"));
    ReadOptions options;
    options.part = "13";
    EXPECT_EQ(read_clip(path, options).frames(), 7);
    EXPECT_TRUE(contains(refusal([&] { read_clip(path); }), "dance_0, dance_13"));
    options.part = "2";
    EXPECT_TRUE(contains(refusal([&] { read_clip(path, options); }), "no part \"2\""));
  }
}

std::string doubles(const std::vector<double>& data) {
  return {reinterpret_cast<const char*>(data.data()), 8 * data.size()};
}

// joblib.dump: a wrapper in place of each array, whose bytes follow it, aligned or not.
void add_joblib_array(PickleWriter& writer, std::string& padding, const std::vector<double>& data,
                      std::size_t rows, std::size_t columns) {
  writer.global("joblib.numpy_pickle", "NumpyArrayWrapper");
  writer.raw(")\x81}(");
  writer.text("subclass");
  writer.global("numpy", "ndarray");
  writer.text("shape");
  writer.raw("M");
  writer.raw({static_cast<char>(rows), 0});
  writer.raw("M");
  writer.raw({static_cast<char>(columns), 0});
  writer.raw("\x86");
  writer.text("order");
  writer.text("C");
  writer.text("dtype");
  writer.dtype();
  writer.text("allow_mmap");
  writer.raw("\x88");
  if (!padding.empty()) {
    writer.text("numpy_array_alignment_bytes");
    writer.raw("K\x10");
  }
  writer.raw("ub");
  if (!padding.empty()) writer.raw(padding);
  writer.raw(doubles(data));
}

std::string joblib_file(const Clip& clip, std::string padding) {
  const auto n = static_cast<std::size_t>(clip.frames());
  PickleWriter writer({4, "numpy.core", false, false, 8});
  writer.global("collections", "defaultdict");  // as WHAM's results are
  writer.global("builtins", "dict");
  writer.raw("\x85R(K\x02");
  writer.begin_dictionary();
  writer.text("pose");
  add_joblib_array(writer, padding, values(clip, 0, 72), n, 72);
  writer.text("trans");
  add_joblib_array(writer, padding, translations(clip), n, 3);
  writer.text("joints2d");
  writer.raw("N");
  writer.raw("uu");
  return writer.finish();
}

TEST(SmplFiles, ReadsJoblibsArraysAlsoCompressed) {
  const Scratch scratch;
  const Clip walk = walker(), camera = in_world(walk, UpAxis::minus_y);
  for (const std::string& padding : {""s, "\x03\xff\xff\xff"s, "\0"s}) {
    const std::string bytes = joblib_file(camera, padding);
    EXPECT_LT(apart(read_clip(scratch.put("a.pkl", bytes)), walk), 1e-9);
    std::string packed(compressBound(bytes.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    packed.resize(size);
    const auto path = scratch.put("z.pkl", packed);
    EXPECT_LT(apart(read_clip(path), walk), 1e-9);
    scratch.put("z.pkl", packed.substr(0, packed.size() / 2));
    EXPECT_TRUE(contains(refusal([&] { read_clip(path); }), "cut off or damaged"));
  }
}

// A tensor in a plain pickle: torch.save's older form inside.
std::string legacy_storage(const std::vector<double>& data) {
  std::string bytes =
      "\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80\x02M\xe9\x03.\x80\x02}."s;
  bytes +=
      "\x80\x02(U\x07storagectorch\nDoubleStorage\nU\x01"
      "0U\x03"
      "cpuM"s;
  bytes += {static_cast<char>(data.size() & 255), static_cast<char>(data.size() >> 8)};
  bytes +=
      "NtQ.\x80\x02]U\x01"
      "0a."s;
  const std::uint64_t count = data.size();
  for (int b = 0; b < 8; ++b) bytes += static_cast<char>(count >> 8 * b & 255);
  return bytes + doubles(data);
}

void add_shape(PickleWriter& writer, const std::vector<std::size_t>& shape) {
  writer.raw("(");
  for (const std::size_t n : shape) writer.op("M", n, 2);
  writer.raw("t");
}

void add_tensor(PickleWriter& writer, const std::function<void()>& storage,
                const std::vector<std::size_t>& shape, const std::vector<std::size_t>& stride) {
  writer.global("torch._utils", "_rebuild_tensor_v2");
  writer.raw("(");
  storage();
  writer.raw("K"s + '\0');
  add_shape(writer, shape);
  add_shape(writer, stride);
  writer.raw("\x89");
  writer.global("collections", "OrderedDict");
  writer.raw(")RtR");
}

TEST(SmplFiles, ReadsPyTorchsTensors) {
  const Scratch scratch;
  const Clip walk = walker(6);
  const auto n = static_cast<std::size_t>(walk.frames());
  struct Part {
    std::string key;
    std::vector<double> data;
    std::vector<std::size_t> shape, stride;
  };
  // The translation lies column after column, the shape is one row repeated.
  std::vector<double> turned;
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index t = 0; t < walk.frames(); ++t) turned.push_back(walk.trans(t, c));
  const std::vector<Part> parts = {{"global_orient", matrices(walk, 0, 1), {n, 3, 3}, {9, 3, 1}},
                                   {"body_pose", values(walk, 3, 63), {n, 63}, {63, 1}},
                                   {"transl", turned, {n, 3}, {1, n}},
                                   {"betas", {0.5, -1}, {n, 2}, {0, 1}}};
  const auto check = [&](const std::filesystem::path& path) {
    const Clip clip = read_clip(path);
    EXPECT_LT(apart(clip, walk), 1e-9);
    ASSERT_TRUE(clip.body);
    EXPECT_EQ(clip.body->betas, (std::vector<double>{0.5, -1}));
  };
  for (const char* name : {"sample_0.pkl", "old.pt"}) {
    PickleWriter writer({4, "numpy.core", false, false, 8});
    writer.begin_dictionary();
    for (const Part& part : parts) {
      writer.text(part.key);
      add_tensor(
          writer,
          [&] {
            writer.global("torch.storage", "_load_from_bytes");
            const std::string bytes = legacy_storage(part.data);
            writer.op("B", bytes.size(), 4);
            writer.raw(bytes + "\x85R");
          },
          part.shape, part.stride);
    }
    writer.end_dictionary();
    check(scratch.put(name, writer.finish()));
  }
  // torch.save's archive, with GVHMR's two views of one person.
  PickleWriter writer({2, "numpy.core", false, false, 8});
  Entries entries;
  writer.begin_dictionary();
  writer.text("smpl_params_global");
  writer.begin_dictionary();
  for (const Part& part : parts) {
    const std::string key = std::to_string(entries.size());
    entries.emplace_back("results/data/" + key, doubles(part.data));
    writer.text(part.key);
    add_tensor(
        writer,
        [&] {
          writer.raw("(");
          writer.text("storage");
          writer.global("torch", "DoubleStorage");
          writer.text(key);
          writer.text("cuda:0");
          writer.op("M", part.data.size(), 2);
          writer.raw("tQ");
        },
        part.shape, part.stride);
  }
  writer.raw("u");
  writer.text("smpl_params_incam");
  writer.raw("}u");
  entries.insert(entries.begin(), {"results/data.pkl", writer.finish()});
  write_zip(scratch / "hmr4d_results.pt", entries);
  check(scratch / "hmr4d_results.pt");
  EXPECT_TRUE(remarked(read_clips(scratch / "hmr4d_results.pt")[0], "world of two"));
}

// 4D-Humans' tracker: a dictionary of frames with lists of people.
TEST(SmplFiles, FollowsPeopleThroughDictionariesOfFrames) {
  const Scratch scratch;
  const Clip walk = walker(9), camera = in_world(walk, UpAxis::minus_y);
  PickleWriter writer({4, "numpy.core", false, false, 8});
  writer.begin_dictionary();
  for (Eigen::Index t = walk.frames() - 1; t >= 0; --t) {  // not in order
    const Clip frame = slice(camera, t, 1);
    writer.text("img/00" + std::to_string(t) + ".jpg");
    writer.begin_dictionary();
    writer.text("tid");
    writer.raw("](K\x05");
    if (t > 3) writer.raw("K\x06");
    writer.raw("e");
    writer.text("smpl");
    writer.raw("](");
    for (int person = 0; person < (t > 3 ? 2 : 1); ++person) {
      writer.begin_dictionary();
      writer.text("global_orient");
      writer.array(values(frame, 0, 3), 1, 3);
      writer.text("body_pose");
      writer.array(values(frame, 3, 69), 23, 3);
      writer.end_dictionary();
    }
    writer.raw("e");
    writer.text("camera");
    writer.raw("](");
    for (int person = 0; person < (t > 3 ? 2 : 1); ++person)
      writer.array(translations(frame), 3, 0);
    writer.raw("eu");
  }
  writer.end_dictionary();
  const std::vector<ReadMotion> motions = read_clips(scratch.put("demo.pkl", writer.finish()));
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[0].clip.name, "demo_5");
  EXPECT_LT(apart(motions[0].clip, walk), 1e-9);
  EXPECT_LT(apart(motions[1].clip, slice(walk, 4, 5)), 1e-9);
}

TEST(SmplFiles, NamesWhatIsOutOfReach) {
  const Scratch scratch;
  const auto says = [&](const Entries& entries, const std::string& part) {
    write_zip(scratch / "a.npz", entries);
    const std::string text = refusal([&] { read_clip(scratch / "a.npz"); });
    EXPECT_TRUE(contains(text, "a.npz") && contains(text, part)) << text;
  };
  const std::vector<double> zeros(4 * 23 * 6, 0);
  const auto transl = entry("transl", zeros, {4, 3});
  says({entry("betas", zeros, {16})}, "shape.npz");
  says({entry("expressions", zeros, {4, 10}), entry("jaw_pose", zeros, {4, 3})}, "face");
  says({entry("joints", zeros, {4, 22, 3})}, "joints");
  says({entry("v_template", zeros, {8, 3}), entry("shapedirs", zeros, {8, 3, 2})}, "--body");
  says({entry("global_orient", zeros, {4, 1, 6}), entry("body_pose", zeros, {4, 23, 6}), transl},
       "6-d rotations");
  says({entry("global_orient", zeros, {4, 3}), entry("body_pose", zeros, {4, 20, 3}), transl},
       "(4, 20, 3)");
  says({entry("global_orient", zeros, {4, 3}), entry("body_pose", zeros, {3, 69}), transl},
       "frames");
  says({entry("global_orient", zeros, {4, 3, 3}), entry("body_pose", zeros, {4, 69}), transl},
       "no rotation");
  says({entry("anything", zeros, {4, 3})}, "global_orient and body_pose, only anything");
  for (const auto& [bytes, what] : std::vector<std::pair<std::string, std::string>>{
           {"\x89HDF\r\n\x1a\n", "HDF5"},
           {"BZh91AY", "bzip2"},
           {"version https://git-lfs.github.com/spec/v1\n", "Git LFS"},
           {"{\"poses\": []}", "JSON"},
           {"(dp0\n", "protocol 0"}}) {
    const auto path = scratch.put("a.pkl", bytes);
    EXPECT_TRUE(contains(refusal([&] { read_clip(path); }), what)) << what;
  }
}

TEST(SmplFiles, SurvivesCutsAndFlippedBits) {
  const Scratch scratch;
  const std::string good = joblib_file(in_world(walker(2), UpAxis::minus_y), "\x01\xff");
  PickleWriter writer({4, "numpy.core", false, false, 8});
  writer.begin_dictionary();
  writer.text("pose");
  add_tensor(writer,
             [&] {
               writer.global("torch.storage", "_load_from_bytes");
               const std::string bytes = legacy_storage(values(walker(2), 0, 72));
               writer.op("B", bytes.size(), 4);
               writer.raw(bytes + "\x85R");
             },
             {2, 72}, {72, 1});
  writer.end_dictionary();
  Random random(5);
  for (const std::string& file : {good, writer.finish()}) {
    const auto check = [&](const std::string& bytes) {
      const auto path = scratch.put("a.pkl", bytes);
      return reads_or_refuses([&] { read_clips(path); }, path.string());
    };
    ASSERT_TRUE(check(file));
    for (std::size_t size = 0; size < file.size(); size += 1 + file.size() / 300)
      EXPECT_FALSE(check(file.substr(0, size)));
    for (int i = 0; i < 1200; ++i) {
      std::string bytes = file;
      const std::size_t at = random.below(i % 3 == 0 ? bytes.size() : 500);
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.below(8));
      check(bytes);
    }
  }
}

}  // namespace
}  // namespace mocaplm::smpl_files_test
