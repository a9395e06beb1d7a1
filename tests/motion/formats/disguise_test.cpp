#include "motion/formats/disguise.h"

#include <gtest/gtest.h>

#include "motion/formats/formats.h"
#include "motion/formats/helpers.h"

namespace mocaplm::disguise_test {
namespace {

std::string zip_with(const std::string& entry) {
  std::string zip("PK\3\4", 4);
  zip.resize(26, '\0');
  zip += static_cast<char>(entry.size());
  zip += std::string(3, '\0');
  return zip + entry + std::string(40, 'x');
}

TEST(Disguise, IsCalledWhatItIsWhateverTheExtension) {
  struct Case {
    std::string content, message;
  };
  const std::vector<Case> cases = {
      {"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 144063\n",
       "is a Git LFS pointer, not the file itself: run git lfs pull"},
      {"<!DOCTYPE html>\n<html lang=\"en\">", "is a web page (HTML)"},
      {"\xEF\xBB\xBF\r\n  <HTML><head>", "is a web page (HTML)"},
      {"<?xml version=\"1.0\"?><Error><Code>AccessDenied</Code></Error>", "server's error message"},
      {"404: Not Found", "server's error message"},
      {zip_with("dance/walk.bvh"), "is a zip archive (its first entry: dance/walk.bvh): unpack it"},
      {"\x1f\x8b\x08 and so on", "is packed by gzip: unpack it"},
      {"", "is empty"}};
  const Scratch scratch;
  for (const Case& c : cases)
    for (const std::string name : {"walk.bvh", "walk.BVH", "walk.npz", "walk.pkl", "walk.fbx",
                                   "walk.glb", "walk.csv", "walk"}) {
      if (c.message.find("zip") != std::string::npos && name == "walk.npz") continue;
      // joblib packs its pickles by gzip itself.
      if (c.message.find("gzip") != std::string::npos && name == "walk.pkl") continue;
      const auto path = scratch.put(name, c.content);
      const std::string message = refusal([&] { read_clip(path); });
      EXPECT_NE(message.find(path.string()), std::string::npos) << message;
      EXPECT_NE(message.find(c.message), std::string::npos) << message;
    }
  EXPECT_NE(refusal([&] {
              read_clip(scratch.put("walk.bvh", std::string("\xFF\xFEH\0I\0", 6)));
            }).find("UTF-16"),
            std::string::npos);
}

TEST(Disguise, WhatItIsNotGoesOn) {
  refuse_disguised("HIERARCHY\nROOT Hips\n", "walk.bvh");
  refuse_disguised(zip_with("poses.npy"), "walk.npz");
  refuse_disguised(zip_with("poses.npy"), "walk.bvh");  // said by its reader: rename it
  refuse_disguised("\x80\x04", "walk.pkl");
  refuse_disguised("glTF\2", "walk.glb");
  refuse_disguised("<?xml version=\"1.0\"?><COLLADA>", "walk.dae");
  refuse_disguised("PK", "walk.npz");
  refuse_disguised(std::string("PK\3\4", 4), "walk.npz");
}

}  // namespace
}  // namespace mocaplm::disguise_test
