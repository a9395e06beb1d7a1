// The limb-direction error over every file of ../shared/data.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/temporary_folder.h"
#include "motion/formats/retarget.h"

namespace mocaplm::retarget_slow_test {
namespace {

namespace fs = std::filesystem;

TEST(RetargetSlow, LimbDirectionsOfAllFiles) {
  const std::string data = std::string(MOCAPLM_SOURCE_DIR) + "/../shared/data";
  if (!fs::exists(data)) GTEST_SKIP() << "no " << data;
  const TemporaryFolder directory;
  for (const char* archive : {"cmu-dance", "bandai-1", "bandai-2"}) {
    const std::string command = "tar -xf '" + data + "/" + archive + "-bvh.tar.xz' -C '" +
                                directory.path().string() + "' 2> /dev/null";
    if (std::system(command.c_str()) != 0)
      GTEST_SKIP() << "cannot unpack " << archive << " (needs tar and xz)";
  }
  int files = 0;
  double sum = 0, worst = 0;
  for (const auto& entry : fs::recursive_directory_iterator(directory.path())) {
    if (entry.path().extension() != ".bvh") continue;
    RetargetReport report;
    const Clip clip = read_bvh_clip(entry.path(), {}, &report);
    check_clip(clip, entry.path().string());
    EXPECT_EQ(report.limbs.size(), 8u);
    EXPECT_LT(report.mean_degrees, 0.01) << entry.path();
    sum += report.mean_degrees;
    worst = std::max(worst, report.max_degrees);
    ++files;
  }
  EXPECT_EQ(files, 1087);
  std::cout << files << " files: mean " << sum / files << ", max " << worst << " degrees\n";
}

}  // namespace
}  // namespace mocaplm::retarget_slow_test
