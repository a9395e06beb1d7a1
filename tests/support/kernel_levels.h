// A test fixture that runs once for each set of instructions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "generate/kernels/level.h"

namespace mocaplm {

class EveryKernel : public testing::TestWithParam<KernelLevel> {
 protected:
  void SetUp() override {
    if (GetParam() > best_kernel_level())
      GTEST_SKIP() << "this processor has no " << to_string(GetParam());
    set_kernel_level(GetParam());
  }
  void TearDown() override { set_kernel_level(best_kernel_level()); }
};

inline auto all_levels() {
  return testing::Values(KernelLevel::plain, KernelLevel::avx2, KernelLevel::avx512,
                         KernelLevel::avx512_bf16);
}

inline std::string level_name(const testing::TestParamInfo<KernelLevel>& info) {
  switch (info.param) {
    case KernelLevel::avx512_bf16:
      return "avx512_bf16";
    case KernelLevel::avx512:
      return "avx512";
    case KernelLevel::avx2:
      return "avx2";
    default:
      return "plain";
  }
}

}  // namespace mocaplm
