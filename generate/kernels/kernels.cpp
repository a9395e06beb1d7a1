#include "generate/kernels/kernels.h"

namespace mocaplm {

const Kernels& kernels() {
#if defined(MOCAPLM_X86_KERNELS)
  switch (kernel_level()) {
    case KernelLevel::avx512_bf16:
      return kAvx512Bf16Kernels;
    case KernelLevel::avx512:
      return kAvx512Kernels;
    case KernelLevel::avx2:
      return kAvx2Kernels;
    default:
      break;
  }
#endif
  return kPlainKernels;
}

}  // namespace mocaplm
