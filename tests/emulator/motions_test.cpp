#include "emulator/motions.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/temporary_folder.h"
#include "motion/skeleton.h"
#include "motion/synth.h"

namespace mocaplm::motions_test {

namespace {

std::vector<Clip> dances(std::size_t count) {
  SynthConfig config;
  config.fps = 20;
  config.genres = {"WA"};
  std::vector<Clip> clips;
  const auto plan = plan_dances(config);
  for (std::size_t k = 0; k < count; ++k) {
    config.seconds = 2 + 0.1 * static_cast<double>(k);
    clips.push_back(make_dance(plan.at(k), config));
  }
  return clips;
}

TEST(Motions, ClipsToAModelToClips) {
  const auto clips = dances(8);
  LandmarkOptions landmarks;
  AlignOptions align;
  align.iterations = 1;
  const PreparedMotions prepared = prepare_motions(clips, landmarks, align, 2);
  EXPECT_EQ(prepared.sequences().size(), 8u);
  EXPECT_EQ(prepared.tree.limbs(), 23);
  EXPECT_NEAR(prepared.seconds[3], static_cast<double>(clips[3].frames() - 1) / 20, 1e-12);
  // A clip is aligned to the template as it was before.
  EXPECT_LT(sequence_distance(prepare_like(prepared, {clips[2]})[0], prepared.sequences()[2]),
            1e-9);
  MotionEmulator motions = fit_motions(prepared, parse_scheme("SIEM/SequentialPCA/MVG"), {});
  motions.where = {"genre=waack"};
  motions.data = "ds";
  const TemporaryFolder folder;
  const auto file = folder.path() / "waack.json";
  save_motion_emulator(file, motions);
  const MotionEmulator again = load_motion_emulator(file);
  EXPECT_EQ(again.where, motions.where);
  for (const bool timing : {false, true}) {
    const auto a = sample_clips(motions, 3, 5, timing, 25),
               b = sample_clips(again, 3, 5, timing, 25);
    ASSERT_EQ(a.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NO_THROW(check_clip(a[k], "x"));
      EXPECT_LT((a[k].poses - b[k].poses).cwiseAbs().maxCoeff(), 1e-7);
      EXPECT_EQ(a[k].labels.at("genre"), "waack");
      EXPECT_EQ(a[k].fps, 25);
      EXPECT_GT(a[k].seconds(), 1.9);
      EXPECT_LT(a[k].seconds(), 3);
    }
    if (!timing) {
      EXPECT_NEAR(a[0].seconds(), prepared.mean_seconds() + 1.0 / 25, 0.03);
    }
  }
}

// The emulated body moves like the clips: its limbs' directions are the sample's.
TEST(Motions, SampledClipsHaveTheSampledDirections) {
  const PreparedMotions prepared = prepare_motions(dances(6), {}, {}, 2);
  SchemeOptions options;
  const MotionEmulator motions = fit_motions(prepared, parse_scheme("PWI"), options);
  const auto sequence = motions.emulator->sample(1, 9)[0];
  const double fps = static_cast<double>(sequence.frames() - 1) / prepared.mean_seconds();
  const Clip clip = sample_clips(motions, 1, 9, false, fps)[0];
  ASSERT_EQ(clip.frames(), sequence.frames());
  const PostureSequence back = clip_postures(clip, prepared.tree, "keep");
  for (Eigen::Index t = 0; t < clip.frames(); t += 5)
    for (const char* joint : {"left_elbow", "right_wrist", "left_knee", "right_ankle", "spine3"}) {
      const Eigen::Index limb = joint_index(joint) - 1;
      EXPECT_LT((back.at(t).col(limb) - sequence.at(t).col(limb)).norm(), 1e-6) << joint;
    }
}

TEST(Motions, BadClipsAreNamed) {
  auto clips = dances(3);
  clips[1] = slice(clips[1], 0, 1);
  try {
    prepare_motions(clips, {}, {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find(clips[1].name + ": a clip of one frame"),
              std::string::npos)
        << error.what();
  }
  EXPECT_THROW(prepare_motions({}, {}, {}), DataError);
  const PreparedMotions one = prepare_motions({clips[0]}, {}, {});
  EXPECT_THROW(fit_motions(one, parse_scheme("PWI"), {}), DataError);
  clips[2].poses(3, 3) = std::nan("");
  EXPECT_THROW(prepare_motions({clips[0], clips[2]}, {}, {}), DataError);
}

TEST(Motions, DamagedFilesAreRefused) {
  const MotionEmulator motions =
      fit_motions(prepare_motions(dances(4), {}, {}), parse_scheme("SIEM/MPCA/IG"), {});
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.json";
  save_motion_emulator(file, motions);
  const Json sound = load_json(file);
  const auto refused = [&](const std::function<void(Json&)>& damage) {
    Json json = sound;
    damage(json);
    save_json(file, json);
    EXPECT_THROW(load_motion_emulator(file), DataError);
  };
  refused([](Json& j) { j["version"] = 2; });
  refused([](Json& j) { j["format"] = "mocaplm tokenizer"; });
  refused([](Json& j) { j["more"] = 2; });
  refused([](Json& j) { j["where"] = {"waack"}; });
  refused([](Json& j) { j.erase("turns"); });
  refused([](Json& j) { j["seconds"][0] = -1; });
  refused([](Json& j) { j["warpings"]["values"][3] = 9; });
  refused([](Json& j) { j["template"]["values"][0] = 9; });
  refused([](Json& j) { j["landmarks"]["joints"] = {"pelvis", "head"}; });
  refused([](Json& j) { j["emulator"]["reference"]["values"][1] = 7; });
  write_file(file, "{\"format\": \"mocaplm emul");
  EXPECT_THROW(load_motion_emulator(file), DataError);
}

}  // namespace

}  // namespace mocaplm::motions_test
