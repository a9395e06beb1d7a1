#include "app/machine.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "common/parallel.h"
#include "common/text.h"
#include "generate/kernels/level.h"
#include "model/config.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// What follows "name:" in a file of /proc, "" where there is none.
std::string proc_value(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name, 0) != 0) continue;
    const std::size_t colon = line.find(':');
    const std::size_t at = line.find_first_not_of(" \t", colon + 1);
    if (colon != std::string::npos && at != std::string::npos) return line.substr(at);
  }
  return "";
}

std::uint64_t kibibytes(const std::string& name) {
  return 1024 * std::strtoull(proc_value("/proc/meminfo", name).c_str(), nullptr, 10);
}

double parameters_of(std::int64_t n_layer, std::int64_t n_embd) {
  ModelDescription description;
  description.shape = {364, 4, 360, 42};
  description.config.n_layer = n_layer;
  description.config.n_embd = n_embd;
  return parameter_count(description);
}

}  // namespace

Machine this_machine() {
  Machine machine;
  machine.processor = proc_value("/proc/cpuinfo", "model name");
  machine.cores = worker_count(0);
  machine.instructions = to_string(kernel_level());
  machine.memory = kibibytes("MemTotal");
  machine.free = kibibytes("MemAvailable");
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    machine.memory_limit = limit.rlim_cur;
  std::error_code error;
  const fs::space_info space = fs::space(fs::current_path(error), error);
  if (!error) machine.disk = space.available;
  return machine;
}

std::string format_bytes(std::uint64_t bytes) {
  const double gibibytes = static_cast<double>(bytes) / (1 << 30);
  return gibibytes < 1 ? format_fixed(1024 * gibibytes, 0) + " MiB"
                       : format_fixed(gibibytes, 1) + " GiB";
}

std::string ModelOfSize::options() const {
  return "--n-layer " + std::to_string(n_layer) + " --n-embd " + std::to_string(n_embd);
}

ModelOfSize model_of_size(double parameters) {
  ModelOfSize best;
  // As deep as the usual models of their width: 4 blocks at 192, 8 at 512, 12 at 768.
  for (std::int64_t width = 32; width <= 4096; width += 32) {
    const std::int64_t layers = std::max<std::int64_t>(width <= 320 ? 4 : 8, width / 64);
    const double size = parameters_of(layers, width);
    if (size > parameters) break;
    best = {layers, width, size};
  }
  return best;
}

}  // namespace mocaplm
