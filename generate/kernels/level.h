// Which instructions the decoding kernels may use, and in which precision they keep the weights.
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

// In rising order; each contains the ones before. avx512 means F, BW, DQ, VL and VNNI; avx512_bf16
// also BF16.
enum class KernelLevel { plain, avx2, avx512, avx512_bf16 };

// The best level of this processor; set_kernel_level forces a lower one (tests).
KernelLevel best_kernel_level();
KernelLevel kernel_level();
void set_kernel_level(KernelLevel level);
std::string to_string(KernelLevel level);

// f32 is the reference. bf16 keeps weights and the key/value cache in the upper half of an f32.
// int8 keeps weights in 8 bits with a scale an output, turns each row of activations into 8 bits
// with a scale of its own, and has bf16's cache.
enum class Precision { f32, bf16, int8 };

std::string to_string(Precision precision);
// In the order of Precision; the precision of one of these names.
const std::vector<std::string>& precision_names();
Precision named_precision(const std::string& name);

}  // namespace mocaplm
