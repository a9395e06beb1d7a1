// What the processor can do, read once from CPUID.
#pragma once

namespace mocaplm::cpu {

// AVX-512 F, BW, DQ, VL and BF16, allowed by the operating system, and kernels for them built in.
bool has_avx512_bf16();
// For tests: false makes this program use what every processor can do.
void allow_avx512(bool allowed);

}  // namespace mocaplm::cpu
