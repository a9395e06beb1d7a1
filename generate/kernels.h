// The inner loops of the decoding engine: f32 products with packed weights, for the instruction
// sets that the processor has (AVX-512, AVX2 with FMA, plain C++), chosen once at run time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mocaplm {

enum class KernelLevel { plain, avx2, avx512 };

// The best level of this processor; set_kernel_level forces a lower one (tests).
KernelLevel best_kernel_level();
KernelLevel kernel_level();
void set_kernel_level(KernelLevel level);
std::string to_string(KernelLevel level);

// Threads of the kernels, 0 for all cores.
void set_engine_threads(int threads);

// A linear layer y = W x + b with W (out, in), packed in panels of kPanel outputs so that decoding
// one row streams through memory in order.
class PackedLinear {
 public:
  static constexpr std::int64_t kPanel = 32;

  PackedLinear() = default;
  PackedLinear(const float* weight, const float* bias, std::int64_t out, std::int64_t in);

  // x: (rows, in) row-major, y: (rows, out). Panels are shared among OpenMP's threads.
  void apply(const float* x, float* y, std::int64_t rows) const;

  std::int64_t in() const { return in_; }
  std::int64_t out() const { return out_; }

 private:
  std::int64_t out_ = 0, in_ = 0;
  std::vector<float> panels_;  // [panel][in][kPanel]
  std::vector<float> bias_;    // padded to whole panels
};

// One query of one head over `count` cached keys and values (count, width), `stride` floats apart.
// out (width) = softmax(q . k / sqrt(width)) v. `scores` is scratch of at least `count` floats.
void attend(const float* query, const float* keys, const float* values, std::int64_t count,
            std::int64_t stride, std::int64_t width, float* scores, float* out);

// Normalises each row of x (rows, width) to mean 0 and variance 1, then scales and shifts.
void layer_norm(const float* x, const float* weight, const float* bias, std::int64_t rows,
                std::int64_t width, float* y);

// GELU x Phi(x), in place.
void gelu(float* x, std::int64_t count);

}  // namespace mocaplm
