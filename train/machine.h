// What trains here and how fast: LibTorch, its devices, and training steps of a model of known
// size.
#pragma once

#include <cstdint>
#include <string>

namespace mocaplm {

struct TrainingLibrary {
  std::string version;   // of LibTorch, as its headers say: "1.13.0" those of Debian's 1.13.1
  bool cuda = false;     // it was built for CUDA
  int cuda_devices = 0;  // that it finds
  int threads = 0;       // of the processor
  bool kernels = false;  // the processor has what our own training kernels need
};
// Throws UsageError when the address space is limited to less than LibTorch needs.
TrainingLibrary training_library(int threads = 0);

struct TrainingSpeed {
  double parameters = 0;
  double seconds_a_step = 0;  // median
  double tokens_per_second = 0;

  // 6 FLOPs a parameter and token: forward pass, and backward pass counted twice (Kaplan et al.
  // 2020); what attention adds is left out.
  double flops() const { return 6 * parameters * tokens_per_second; }
};

struct MachineSpeed {
  std::string device, precision;  // "cpu", "bf16": of the training steps
  double products = 0;            // FLOP/s of a large matrix product in f32, LibTorch's
  TrainingSpeed training;
};

// Measures for about `seconds` (0.1 to 600) in all: matrix products, then whole steps (forward,
// backward, clipping, AdamW) of the default model on made-up motion. Throws as choose_device does.
MachineSpeed measure_training(const std::string& device, int threads, double seconds);

// Parameters of a model that sees 20 tokens for each of them (Hoffmann et al. 2022) in that time:
// 6 N * 20 N FLOPs at `flops` a second.
double parameters_for(double flops, double seconds);

}  // namespace mocaplm
