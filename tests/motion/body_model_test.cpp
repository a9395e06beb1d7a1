// Joints of a body's shape, and shapes that stay with their motion.
#include "motion/body_model.h"

#include <gtest/gtest.h>

#include "motion/edit.h"
#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"
#include "motion/formats/npz.h"
#include "motion/formats/smpl_files.h"
#include "motion/formats/zip_file.h"
#include "motion/mirror.h"
#include "motion/resample.h"

namespace mocaplm::body_model_test {
namespace {

struct MadeUpModel {
  std::size_t vertices = 60, coefficients = 4, joints = 24;
  std::vector<double> points, directions, weights;

  explicit MadeUpModel(std::size_t j, std::size_t b = 4) : coefficients(b), joints(j) {
    Random random(j);
    for (std::size_t i = 0; i < 3 * vertices; ++i) points.push_back(random.uniform(-1, 1));
    for (std::size_t i = 0; i < 3 * vertices * b; ++i)
      directions.push_back(random.uniform(-0.05, 0.05));
    for (std::size_t i = 0; i < joints * vertices; ++i)
      weights.push_back(random.below(4) == 0 ? random.uniform(0, 0.2) : 0);
  }
  Entries entries() const {
    return {entry("v_template", points, {vertices, 3}),
            entry("shapedirs", directions, {vertices, 3, coefficients}),
            entry("J_regressor", weights, {joints, vertices})};
  }
  // The definition, written plainly: the shaped body's vertices, then their weighted sum.
  Eigen::RowVector3d joint(std::size_t j, const std::vector<double>& betas) const {
    Eigen::RowVector3d sum(0, 0, 0);
    for (std::size_t v = 0; v < vertices; ++v)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double at = points[3 * v + axis];
        for (std::size_t b = 0; b < betas.size(); ++b)
          at += betas[b] * directions[(3 * v + axis) * coefficients + b];
        sum[static_cast<Eigen::Index>(axis)] += weights[j * vertices + v] * at;
      }
    return sum;
  }
};

TEST(BodyModel, JointsAreTheRegressedOnes) {
  const Scratch scratch;
  const std::vector<double> betas = {0.5, -2, 1, 0.25};
  for (const std::size_t count : {24, 52, 55}) {
    const MadeUpModel made(count);
    write_zip(scratch / "m.npz", made.entries());
    const RestJoints joints = BodyModel(scratch / "m.npz").joints(betas);
    for (std::size_t j = 0; j < 24; ++j) {
      std::size_t from = j;  // hands: the base of the middle finger
      if (count == 52 && j >= 22) from = j == 22 ? 25 : 40;
      if (count == 55 && j >= 22) from = j == 22 ? 28 : 43;
      EXPECT_LT((joints.row(static_cast<Eigen::Index>(j)) - made.joint(from, betas)).norm(), 1e-12);
    }
  }
}

// scipy's compressed columns and chumpy's array in a pickle of protocol 2, as SMPL's files are.
std::string smpl_pickle(const MadeUpModel& made) {
  PickleWriter writer({2, "numpy.core", false, false, 8});
  writer.begin_dictionary();
  writer.text("v_template");
  writer.array(made.points, made.vertices, 3);
  writer.text("shapedirs");
  writer.global("copy_reg", "_reconstructor");
  writer.raw("(");
  writer.global("chumpy.ch", "Ch");
  writer.global("__builtin__", "object");
  writer.raw("NtR}(");
  writer.text("x");
  // (V, 3, B): the writer makes two dimensions, the shape is put in by hand.
  PickleWriter flat({2, "numpy.core", false, false, 8});
  flat.array(made.directions, made.vertices, 3 * made.coefficients);
  std::string array = flat.finish().substr(2);
  array.pop_back();
  std::string from = "M", to = "(M";
  from += {static_cast<char>(made.vertices),         0, 'M',
           static_cast<char>(3 * made.coefficients), 0, '\x86'};
  to +=
      {static_cast<char>(made.vertices), 0, 'K', 3, 'K', static_cast<char>(made.coefficients), 't'};
  array.replace(array.find(from), from.size(), to);
  writer.raw(array + "ub");
  writer.text("J_regressor");
  writer.global("scipy.sparse.csc", "csc_matrix");
  writer.raw(")\x81}(");
  std::vector<double> data, indices, starts = {0};
  for (std::size_t v = 0; v < made.vertices; ++v) {
    for (std::size_t j = 0; j < made.joints; ++j)
      if (const double w = made.weights[j * made.vertices + v]; w != 0) {
        data.push_back(w);
        indices.push_back(static_cast<double>(j));
      }
    starts.push_back(static_cast<double>(data.size()));
  }
  writer.text("_shape");
  writer.raw("K");
  writer.raw({static_cast<char>(made.joints)});
  writer.raw("K");
  writer.raw({static_cast<char>(made.vertices)});
  writer.raw("\x86");
  for (const auto& [key, list] : {std::pair<const char*, std::vector<double>>{"data", data},
                                  {"indices", indices},
                                  {"indptr", starts}}) {
    writer.text(key);
    writer.array(list, list.size(), 0);
  }
  writer.raw("ub");
  writer.end_dictionary();
  return writer.finish();
}

TEST(BodyModel, ReadsTheLicensorsPickles) {
  const Scratch scratch;
  const MadeUpModel made(24);
  const std::vector<double> betas = {1, 2, -1};
  const RestJoints joints = BodyModel(scratch.put("m.pkl", smpl_pickle(made))).joints(betas);
  for (std::size_t j = 0; j < 24; ++j)
    EXPECT_LT((joints.row(static_cast<Eigen::Index>(j)) - made.joint(j, betas)).norm(), 1e-12);
}

TEST(BodyModel, LeavesOutExpressionsAndCoefficientsThatItLacks) {
  const Scratch scratch;
  const MadeUpModel made(55, 20);  // ten of the shape, ten expressions
  write_zip(scratch / "m.npz", made.entries());
  const BodyModel model(scratch / "m.npz");
  EXPECT_EQ(model.coefficients(), 10u);
  const std::vector<double> ten(10, 0.5), many(300, 0.5);
  EXPECT_EQ(model.joints(many), model.joints(ten));
  EXPECT_LT((model.joints({}).row(3) - made.joint(3, {})).norm(), 1e-12);
}

TEST(BodyModel, NamesWhatIsWrong) {
  const Scratch scratch;
  const auto says = [&](const Entries& entries, const std::string& part) {
    write_zip(scratch / "m.npz", entries);
    const std::string text = refusal([&] { BodyModel(scratch / "m.npz"); });
    EXPECT_TRUE(contains(text, "m.npz") && contains(text, part)) << text;
  };
  const MadeUpModel made(24);
  Entries entries = made.entries();
  says({entries[0], entries[1]}, "has no J_regressor");
  says({entries[1], entries[2]}, "has no v_template");
  entries[2] = entry("J_regressor", made.weights, {20, 60});
  says(entries, "20 joints");
  entries = made.entries();
  entries[0] = entry("v_template", made.points, {59, 3});
  says(entries, "(59, 3)");
}

TEST(BodyModel, AClipHasTheJointsOfItsShape) {
  const Scratch scratch;
  const MadeUpModel made(24);
  write_zip(scratch / "m.npz", made.entries());
  const Clip walk = walker();
  Entries entries = amass_entries(in_world(walk, UpAxis::z), 156);
  const std::vector<double> betas = {1, -1, 2, 0.5};
  entries.push_back(entry("betas", betas, {4}));
  write_zip(scratch / "a.npz", entries);
  const auto plain = read_clips(scratch / "a.npz");
  ASSERT_EQ(plain[0].report.remarks.size(), 1u);
  EXPECT_EQ(plain[0].report.remarks[0].kind, "mean body");
  ReadOptions options;
  options.up = UpAxis::z;
  options.body = (scratch / "m.npz").string();
  const auto shaped = read_clips(scratch / "a.npz", options);
  EXPECT_TRUE(shaped[0].report.remarks.empty());
  // SMPL in the file's world: the pelvis at trans + J of this shape, turned as a whole.
  const Clip world = in_world(walk, UpAxis::z);
  for (Eigen::Index t = 0; t < walk.frames(); ++t) {
    const Eigen::RowVector3d at = world.trans.row(t) + made.joint(0, betas);
    const Eigen::RowVector3d pelvis = joint_positions(shaped[0].clip, t).row(0);
    EXPECT_LT((pelvis - Eigen::RowVector3d(at.x(), at.z(), -at.y())).norm(), 1e-9);
  }
  // It stays so in our own files.
  write_npz(scratch / "b.npz", shaped[0].clip);
  EXPECT_LT(apart(read_clip(scratch / "b.npz"), shaped[0].clip), 1e-12);
}

TEST(BodyModel, ShapesStayWithTheirMotion) {
  const Scratch scratch;
  Clip clip = walker(30, 60);
  auto body = std::make_shared<BodyShape>();
  body->betas = {0.25, -1.5, 3};
  body->gender = "female";
  clip.body = body;
  write_npz(scratch / "a.npz", clip);
  const std::string bytes = read_file(scratch / "a.npz");
  const Clip back = read_clip(scratch / "a.npz");
  ASSERT_TRUE(back.body);
  EXPECT_EQ(back.body->betas, body->betas);
  EXPECT_EQ(back.body->gender, "female");
  write_npz(scratch / "b.npz", back);
  EXPECT_EQ(read_file(scratch / "b.npz"), bytes);
  EditConfig config;
  config.fps = 25;
  config.mirror = config.face = config.floor = true;
  for (const Clip& made : {slice(clip, 3, 5), resample(clip, 30), resample(clip, 50), mirror(clip),
                           turned(clip, 1), edited(clip, config)})
    EXPECT_EQ(made.body, clip.body);
}

}  // namespace
}  // namespace mocaplm::body_model_test
