// Pictures against plain calculations, and films as ffmpeg reads them back.
#include "render/render.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdlib>

#include "common/error.h"
#include "common/files.h"
#include "common/find_program.h"
#include "common/temporary_folder.h"
#include "motion/floor.h"
#include "motion/resample.h"
#include "motion/skeleton.h"
#include "render/layer.h"
#include "render/stage.h"
#include "support/refusal.h"
#include "support/run_program.h"
#include "tokenizer/random_clips.h"

namespace mocaplm::render_test {
namespace {

Clip dance(Eigen::Index frames = 20, double fps = 20) {
  Clip clip = random_clip(3, frames, fps, "dance");
  clip.poses.leftCols<3>() *= 0.2;  // upright
  stand_on_ground(clip);
  return clip;
}

RenderConfig small() {
  RenderConfig config;
  config.width = 160;
  config.height = 120;
  return config;
}

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

// A reader of the .png files that this program writes, by the specification.
Picture read_png(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  Picture picture;
  std::string packed;
  for (std::size_t at = 8; at < bytes.size();) {
    const std::size_t length = u32(bytes, at);
    const std::string type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, length);
    const std::string body = type + data;
    EXPECT_EQ(u32(bytes, at + 8 + length), ::crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                   static_cast<uInt>(body.size())));
    if (type == "IHDR") {
      picture = Picture(static_cast<int>(u32(data, 0)), static_cast<int>(u32(data, 4)));
      EXPECT_EQ(data.substr(8), std::string("\10\2\0\0\0", 5));
    }
    if (type == "IDAT") packed += data;
    at += 12 + length;
  }
  const std::size_t stride = 3 * static_cast<std::size_t>(picture.width);
  std::string rows((stride + 1) * static_cast<std::size_t>(picture.height), '\0');
  uLongf size = rows.size();
  EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                         reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  EXPECT_EQ(size, rows.size());
  for (int y = 0; y < picture.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * (stride + 1);
    EXPECT_EQ(rows[row], 2);  // up
    for (std::size_t i = 0; i < stride; ++i)
      picture.at(0, y)[i] =
          static_cast<std::uint8_t>(rows[row + 1 + i] + (y > 0 ? picture.at(0, y - 1)[i] : 0));
  }
  return picture;
}

double mean_difference(const Picture& a, const Picture& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
  return sum / static_cast<double>(a.rgb.size());
}

TEST(Picture, ComesBackFromPng) {
  Random random(1);
  Picture picture(37, 23);
  for (std::uint8_t& byte : picture.rgb) byte = static_cast<std::uint8_t>(random.below(256));
  EXPECT_EQ(read_png(png_bytes(picture)).rgb, picture.rgb);
}

// From the front: x to the right, y up, the box inside, and rays back through the pixels.
TEST(Camera, SeesTheBox) {
  Box box;
  box.add({-2, 0, -1});
  box.add({1, 1.8f, 3});
  for (const double turn : {-2.0, 0.0, 0.3, 3.1})
    for (const double tilt : {0.0, 0.2, 1.4}) {
      const Camera camera(box, turn, tilt, 200, 100);
      float nearest = 1e9f;  // to the picture's edge
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3f point(corner & 1 ? 1 : -2, corner & 2 ? 1.8f : 0,
                                    corner & 4 ? 3 : -1);
        const Eigen::Vector3f at = camera.project(point);
        ASSERT_GT(at.z(), 0.5f);
        nearest = std::min({nearest, at.x(), 200 - at.x(), at.y(), 100 - at.y()});
        const Eigen::Vector3f seen = camera.eye() + at.z() * camera.ray(at.x(), at.y());
        ASSERT_LT((seen - point).norm(), 1e-3);
      }
      EXPECT_GE(nearest, 0) << turn << " " << tilt;
      EXPECT_LT(nearest, 12) << turn << " " << tilt;
    }
  const Camera front(box, 0, 0, 200, 100);
  const Eigen::Vector3f middle = front.project({-.5f, .9f, 1});
  EXPECT_NEAR(middle.x(), 100, 1e-3);
  EXPECT_NEAR(middle.y(), 50, 1e-3);
  EXPECT_GT(front.project({0, .9f, 1}).x(), middle.x());
  EXPECT_LT(front.project({-.5f, 1.2f, 1}).y(), middle.y());
  EXPECT_LT(front.project({-.5f, .9f, 2}).z(), middle.z());
}

// A square in front of another: the share of each pixel is its area, the nearer one is seen, the
// face turned away is not.
TEST(Layer, DrawsAreasByDepth) {
  Box box;
  box.add({-1, -1, 0});
  box.add({1, 1, 0});
  const Camera camera(box, 0, 0, 100, 100);
  MeshPoints points(8, 3), normals(8, 3);
  points << -.5, -.5, 0, .5, -.5, 0, .5, .5, 0, -.5, .5, 0,  //
      -.25, -.25, .1, .25, -.25, .1, .25, .25, .1, -.25, .25, .1;
  normals.setZero();
  normals.col(2).setOnes();
  Picture picture(100, 100);
  Layer layer(100, 100);
  const LinearColour red(1, 0, 0), green(0, 1, 0);
  layer.draw(camera, points, normals, {4, 5, 6, 4, 6, 7}, green);
  layer.draw(camera, points, normals, {0, 1, 2, 0, 2, 3}, red);
  layer.draw(camera, points, normals, {4, 6, 5, 4, 7, 6}, LinearColour(0, 0, 1));  // from behind
  layer.put_over(picture);
  const Eigen::Vector3f corner = camera.project({.5f, .5f, 0}),
                        low = camera.project({-.5f, -.5f, 0});
  double reds = 0, greens = 0, inner = 0;
  const Eigen::Vector3f inner_corner = camera.project({.25f, .25f, .1f});
  inner = 4 * (inner_corner.x() - 50) * (inner_corner.x() - 50);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const std::uint8_t* p = picture.at(x, y);
      reds += p[0] > 60 && p[1] < 60;
      greens += p[1] > 60 && p[0] < 60;
      ASSERT_LT(p[2], 60);
    }
  EXPECT_NEAR(reds + greens, (corner.x() - low.x()) * (low.y() - corner.y()), 120);
  EXPECT_NEAR(greens, inner, 60);
  EXPECT_GT(picture.at(50, 50)[1], 150);
  EXPECT_EQ(picture.at(2, 2)[0], 0);
}

// Where a joint is projected to there is the figure's blue, with a camera that stands still and
// with one that follows; and a frame looks the same whenever it is drawn.
TEST(Stage, DrawsTheFigureWhereItsJointsAre) {
  const Clip clip = dance();
  const auto blue = [](const std::uint8_t* p) { return p[2] > p[0] + 50; };
  for (const bool follow : {false, true}) {
    RenderConfig config = small();
    config.follow = follow;
    const Stage stage(clip, config);
    for (const Eigen::Index t : {0, 10, 19}) {
      const Picture picture = stage.frame(t);
      const JointPositions joints = joint_positions(clip, t);
      for (const int joint : {0, 3, 6, 9, 4, 5, 15, 18, 19}) {
        const Eigen::Vector3f at =
            stage.camera(t).project(joints.row(joint).transpose().cast<float>());
        EXPECT_TRUE(blue(picture.at(static_cast<int>(at.x()), static_cast<int>(at.y()))))
            << follow << " " << t << " " << joint_names()[static_cast<std::size_t>(joint)];
      }
      int found = 0;
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) found += blue(picture.at(x, y));
      EXPECT_LT(found, 160 * 120 / 3);
      EXPECT_GT(mean_difference(picture, stage.frame((t + 7) % 20)), 0.2);
      EXPECT_EQ(picture.rgb, stage.frame(t).rgb);
    }
  }
}

// The darkest part of the floor lies under the feet's side away from the light, and the shadow of
// a body that stands is about as large as its outline seen from above.
TEST(Ground, ShadowLiesUnderTheFigure) {
  Clip clip = dance(1);
  clip.poses.setZero();
  clip.trans.setZero();
  stand_on_ground(clip);
  MeshPoints positions, normals;
  pose_body(clip, 0, positions, normals);
  const Shadow shadow(positions, body_mesh().triangles);
  EXPECT_GT(shadow.at(.1f, 0), 0.5f);   // left foot
  EXPECT_GT(shadow.at(-.1f, 0), 0.5f);  // right foot
  EXPECT_EQ(shadow.at(0, 1.2f), 0);
  EXPECT_EQ(shadow.at(50, 50), 0);
  double area = 0;
  for (int i = 0; i < 400; ++i)
    for (int k = 0; k < 400; ++k)
      area += 1e-4 * shadow.at(static_cast<float>(i) / 100 - 2, static_cast<float>(k) / 100 - 2);
  EXPECT_GT(area, 0.3);
  EXPECT_LT(area, 0.9);
}

class Render : public testing::Test {
 protected:
  void TearDown() override { ::unsetenv("MOCAPLM_FFMPEG"); }
  // A program in ffmpeg's place.
  void pretend(const std::string& script) {
    put((folder_ / "ffmpeg").string(), "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder_ / "ffmpeg", std::filesystem::perms::owner_all);
    ::setenv("MOCAPLM_FFMPEG", (folder_ / "ffmpeg").c_str(), 1);
  }
  TemporaryFolder folder_;
};

TEST_F(Render, WritesAPictureOfAMomentOrOfSeveralPoses) {
  RenderConfig config = small();
  config.at = 0.5;
  EXPECT_EQ(render_clip(dance(), folder_ / "at.png", config, 1), 1);
  const Picture at = read_png(read_file(folder_ / "at.png"));
  EXPECT_EQ(at.width, 160);
  EXPECT_EQ(at.height, 120);
  config.poses = 4;
  render_clip(dance(), folder_ / "poses.png", config, 1);
  EXPECT_GT(mean_difference(at, read_png(read_file(folder_ / "poses.png"))), 1);
  config.poses = 1;
  config.dark = true;
  render_clip(dance(), folder_ / "dark.png", config, 1);
  EXPECT_GT(mean_difference(at, read_png(read_file(folder_ / "dark.png"))), 50);
  config.at = 1;
  EXPECT_TRUE(contains(
      refusal<UsageError>([&] { render_clip(dance(), folder_ / "x.png", config, 1); }), "1.00 s"));
}

TEST_F(Render, HandsEveryFrameToFfmpeg) {
  pretend("for last; do :; done\nwc -c > \"${last#file:}\"\necho \"$@\" >> \"${last#file:}\"\n");
  for (const std::int64_t threads : {1, 3}) {
    EXPECT_EQ(render_clip(dance(20, 20), folder_ / "x.mp4", small(), threads), 29);
    const std::string got = read_file(folder_ / "x.mp4");
    EXPECT_EQ(std::stol(got), 29 * 3 * 160 * 120);
    EXPECT_TRUE(contains(got, "160x120 -framerate 30")) << got;
  }
}

TEST_F(Render, SaysWhatFfmpegSays) {
  const auto said = [&] {
    return refusal([&] { render_clip(dance(), folder_ / "x.mp4", small(), 1); });
  };
  pretend("echo 'Unknown encoder libx264' >&2\nexit 1\n");
  EXPECT_TRUE(contains(said(), "Unknown encoder libx264"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.mp4"));
  pretend("exit 3\n");
  EXPECT_TRUE(contains(said(), "exit code 3"));
  pretend("kill -9 $$\n");
  EXPECT_TRUE(contains(said(), "signal 9"));
  ::setenv("MOCAPLM_FFMPEG", "/nowhere/ffmpeg", 1);
  EXPECT_TRUE(contains(said(), "cannot be run"));
}

TEST_F(Render, RefusesOtherEndingsAndMissesFfmpegByName) {
  EXPECT_TRUE(contains(refusal<UsageError>([] { check_render("x.avi", {}); }), ".mp4"));
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder_.path().c_str(), 1);
  const std::string missing = refusal<UsageError>([] { check_render("x.gif", {}); });
  check_render("x.png", {});
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(contains(missing, "apt-get install ffmpeg")) << missing;
}

TEST_F(Render, RefusesSettingsThatAFileCannotHave) {
  pretend("exit 0\n");
  RenderConfig config = small();
  config.fps = 60;
  check_render("x.mp4", config);
  EXPECT_TRUE(contains(refusal<UsageError>([&] { check_render("x.gif", config); }), "50 pictures"));
  config.poses = 3;
  config.follow = true;
  EXPECT_TRUE(contains(refusal<UsageError>([&] { check_render("x.png", config); }), "--follow"));
}

// More poses than a clip has frames: each is drawn once.
TEST_F(Render, DrawsNoPoseTwice) {
  RenderConfig config = small();
  config.poses = 2;
  render_clip(dance(2), folder_ / "two.png", config, 1);
  config.poses = 24;
  render_clip(dance(2), folder_ / "many.png", config, 1);
  EXPECT_EQ(read_file(folder_ / "two.png"), read_file(folder_ / "many.png"));
}

// Decoded again, the films show the pictures that were drawn.
TEST_F(Render, FilmsShowTheDance) {
  const std::string ffmpeg = find_program("ffmpeg");
  if (ffmpeg.empty()) GTEST_SKIP() << "no ffmpeg: apt-get install ffmpeg";
  RenderConfig config = small();
  config.width = 161;
  config.fps = 10;
  const Clip clip = dance(20, 20);
  const Stage stage(resample(clip, config.fps), config);
  for (const char* name : {"dance.mp4", "dance.gif"}) {
    EXPECT_EQ(render_clip(clip, folder_ / name, config, 2), 10) << name;
    const std::string raw = (folder_ / "raw").string();
    const Ran ran = run_shell(ffmpeg + " -y -loglevel error -i '" + (folder_ / name).string() +
                              "' -fps_mode passthrough -f rawvideo -pix_fmt rgb24 '" + raw + "'");
    ASSERT_EQ(ran.code, 0) << ran.text;
    const std::string bytes = read_file(raw);
    const int width = std::string(name) == "dance.mp4" ? 162 : 161;
    ASSERT_EQ(bytes.size(), static_cast<std::size_t>(10 * 3 * width * 120)) << name;
    for (int f = 0; f < 10; ++f) {
      const Picture wanted = stage.frame(f);
      double difference = 0;
      for (int y = 0; y < 120; ++y)
        for (int i = 0; i < 3 * 161; ++i) {
          const auto at = static_cast<std::size_t>(3 * width * (120 * f + y) + i);
          difference += std::abs(static_cast<unsigned char>(bytes[at]) - int{wanted.at(0, y)[i]});
        }
      EXPECT_LT(difference / (3 * 161 * 120), 4) << name << " " << f;
    }
  }
}

}  // namespace
}  // namespace mocaplm::render_test
