// Devices, number types and threads.
#pragma once

#include <string>

#include "model/transformer/torch.h"

namespace mocaplm {

// "cpu", "cuda", or "auto" (CUDA where there is one). Throws UsageError when CUDA is asked for and
// absent.
at::Device choose_device(const std::string& name);

// "f32", "bf16", or "auto": bf16 where the device multiplies it natively (AVX-512 BF16, AMX, CUDA).
// The weights stay f32 masters; bf16 is the type of the products.
at::ScalarType choose_precision(const std::string& name, const at::Device& device);

// Number of threads (0: all cores) and glibc's thresholds for returning memory: without them every
// step pays page faults for fresh buffers, up to half of its time.
void set_up_cpu(int threads);

}  // namespace mocaplm
