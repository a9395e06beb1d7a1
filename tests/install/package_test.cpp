// `cmake --install` into an empty folder: the program runs there, and another project finds the
// package, builds examples/continue_dance with it and continues a dance.
#include "app/trained_run.h"
#include "motion/formats/formats.h"

namespace fs = std::filesystem;

namespace mocaplm::package_test {
namespace {

class Package : public TrainedRun {
 protected:
  static void SetUpTestSuite() {
    TrainedRun::SetUpTestSuite();
    shell("cmake --install " MOCAPLM_BINARY_DIR " --prefix " + at("prefix"));
  }

  static std::string shell(const std::string& command) {
    const Ran ran = run_shell(command);
    EXPECT_EQ(ran.code, 0) << command << "\n" << ran.text;
    return ran.text;
  }
  static fs::path a_dance() { return fs::directory_iterator(path("data/clips"))->path(); }
};

TEST_F(Package, HoldsTheProgramItsSettingsAndDocuments) {
  for (const char* file : {"bin/mocaplm", "bin/mocaplm-torch", "share/mocaplm/configs/small.json",
                           "share/doc/mocaplm/README.md", "share/doc/mocaplm/LICENSE",
                           "share/doc/mocaplm/docs/tokenizers.md"})
    EXPECT_TRUE(fs::exists(path("prefix") / file)) << file;
  // The light program starts the other one beside it.
  const std::string program = at("prefix/bin/mocaplm");
  EXPECT_NE(shell(program + " info " + at("run")).find("parameters"), std::string::npos);
  EXPECT_NE(shell(program + " train --help").find("--learning-rate"), std::string::npos);
}

TEST_F(Package, LetsAnotherProgramContinueADance) {
  const std::string build = at("example");
  shell("cmake -S " MOCAPLM_SOURCE_DIR "/examples/continue_dance -B " + build +
        " -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH=" + at("prefix"));
  shell("cmake --build " + build);
  const std::string program = at("example/continue_dance"), out = at("out.bvh");
  const std::string said =
      shell(program + " " + at("run") + " '" + a_dance().string() + "' 2.5 " + out);
  EXPECT_NE(said.find("4.0 s"), std::string::npos) << said;  // the clip has 1.5
  const Clip dance = read_clip(path("out.bvh"));
  EXPECT_EQ(dance.frames(), 80);
  EXPECT_NEAR(dance.fps, 20, 1e-4);
  EXPECT_EQ(run_shell(program + " " + at("nothing") + " x.npz 1 " + out).code, 3);
  EXPECT_EQ(run_shell(program + " " + at("run") + " '" + a_dance().string() + "' soon " + out).code,
            2);
}

}  // namespace
}  // namespace mocaplm::package_test
