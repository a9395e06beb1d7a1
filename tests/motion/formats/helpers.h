// Files for the format tests: a scratch folder, expected.json, and "reads soundly or refuses".
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/files.h"
#include "common/json.h"
#include "common/random.h"
#include "common/temporary_folder.h"
#include "motion/clip.h"
#include "support/refusal.h"

namespace mocaplm {

// A temporary folder that files are put into.
class Scratch : public TemporaryFolder {
 public:
  // Plain and quick: no care for what was there (ext4 waits for the disk when a file is
  // overwritten).
  std::filesystem::path put(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path path = *this / name;
    std::filesystem::remove(path);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
};

inline std::filesystem::path shared_formats() {
  return std::filesystem::path(MOCAPLM_SOURCE_DIR) / ".." / "shared" / "data" / "formats";
}

// The entries of expected.json of one format ("amass-npz", "aist-pkl"), as (file name,
// expectation).
inline std::vector<std::pair<std::string, Json>> expected_files(const std::string& format) {
  std::vector<std::pair<std::string, Json>> found;
  const auto path = shared_formats() / "expected.json";
  if (!std::filesystem::exists(path)) return found;
  const Json json = load_json(path);
  for (const auto& [name, expected] : json.at("files").items())
    if (expected.at("format") == format) found.emplace_back(name, expected);
  return found;
}

// First and last frame, sums and rate within 1e-6.
inline void expect_clip(const Clip& clip, const Json& expected, const std::string& name) {
  SCOPED_TRACE(name);
  ASSERT_EQ(clip.frames(), expected.at("frames").get<int>());
  EXPECT_EQ(clip.fps, expected.at("fps").get<double>());
  EXPECT_EQ(clip.name, std::filesystem::path(name).stem());
  const auto last = clip.frames() - 1;
  for (int c = 0; c < 72; ++c) {
    ASSERT_NEAR(clip.poses(0, c), expected.at("poses_first").at(c).get<double>(), 1e-6) << c;
    ASSERT_NEAR(clip.poses(last, c), expected.at("poses_last").at(c).get<double>(), 1e-6) << c;
  }
  for (int c = 0; c < 3; ++c) {
    ASSERT_NEAR(clip.trans(0, c), expected.at("trans_m_first").at(c).get<double>(), 1e-6);
    ASSERT_NEAR(clip.trans(last, c), expected.at("trans_m_last").at(c).get<double>(), 1e-6);
  }
  EXPECT_NEAR(clip.poses.sum(), expected.at("poses_sum").get<double>(), 1e-6);
  EXPECT_NEAR(clip.trans.sum(), expected.at("trans_m_sum").get<double>(), 1e-6);
}

}  // namespace mocaplm
