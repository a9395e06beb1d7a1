// What of the machine and of this installation doctor looks at.
#pragma once

#include <cstdint>
#include <string>

namespace mocaplm {

struct Machine {
  std::string processor;               // its name, "" where it is not told
  std::size_t cores = 0;               // that this process may use
  std::string instructions;            // of the decoding kernels
  std::uint64_t memory = 0, free = 0;  // bytes; 0 where they are not told
  std::uint64_t memory_limit = 0;      // of this process (ulimit -v), 0 for none
  std::uint64_t disk = 0;              // bytes free where the user stands
};
Machine this_machine();

// "3.2 GiB"
std::string format_bytes(std::uint64_t bytes);

// Settings of the largest default model (architecture flat, 360 bins, 42 channels) with at most so
// many parameters: "--n-layer 4 --n-embd 192", and its parameters. Empty below the smallest.
struct ModelOfSize {
  std::int64_t n_layer = 0, n_embd = 0;
  double parameters = 0;
  std::string options() const;
};
ModelOfSize model_of_size(double parameters);

}  // namespace mocaplm
