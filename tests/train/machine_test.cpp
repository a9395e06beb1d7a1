// The speed of this machine, as doctor tells it: what is reckoned, and that a measurement is sane.
#include "train/machine.h"

#include <gtest/gtest.h>

#include <thread>

#include "common/error.h"
#include "support/refusal.h"

namespace mocaplm::machine_test {
namespace {

TEST(Machine, ParametersUseUpTheTime) {
  const double flops = 3e11, seconds = 3600;
  const double n = parameters_for(flops, seconds);
  // So many tokens at so many FLOPs each take just that long.
  EXPECT_NEAR(20 * n * 6 * n / flops, seconds, 1e-6 * seconds);
  EXPECT_NEAR(parameters_for(4 * flops, seconds), 2 * n, 1e-6 * n);
  EXPECT_EQ(parameters_for(0, seconds), 0);
}

TEST(Machine, NamesTheLibrary) {
  const TrainingLibrary library = training_library(1);
  EXPECT_EQ(library.threads, 1);
  ASSERT_FALSE(library.version.empty());
  EXPECT_TRUE(library.version[0] >= '1' && library.version[0] <= '9') << library.version;
}

TEST(Machine, MeasuresStepsOfAModelOfKnownSize) {
  const MachineSpeed speed = measure_training("cpu", 1, 0.1);
  EXPECT_EQ(speed.device, "cpu");
  // The default model, configs/flat.json: 4 blocks, 192 wide.
  EXPECT_GT(speed.training.parameters, 4 * 12 * 192 * 192);
  EXPECT_LT(speed.training.parameters, 3e6);
  EXPECT_GT(speed.training.seconds_a_step, 0);
  // 8 windows of up to 1,024 tokens.
  const double tokens = speed.training.tokens_per_second * speed.training.seconds_a_step;
  EXPECT_GT(tokens, 8 * 900);
  EXPECT_LE(tokens, 8 * 1024 + 1e-6);
  // More than a pocket calculator, less than the largest machines.
  EXPECT_GT(speed.products, 1e7);
  EXPECT_LT(speed.products, 1e18);
  EXPECT_GT(speed.training.flops(), 1e6);
}

TEST(Machine, RefusesADeviceThatIsNotThere) {
  if (training_library().cuda_devices > 0) GTEST_SKIP() << "there is a CUDA device";
  EXPECT_TRUE(contains(refusal<UsageError>([] { measure_training("cuda", 1, 0.1); }), "cuda"));
}

}  // namespace
}  // namespace mocaplm::machine_test
