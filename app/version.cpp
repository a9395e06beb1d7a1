#include "app/version.h"

#include "app/torch_part.h"
#include "common/parallel.h"
#include "generate/kernels/level.h"

namespace mocaplm {

namespace {

std::string torch_line() {
  const TorchAnswer answer = ask_torch_part("about");
  if (!answer.installed)
    return "LibTorch: not installed (" + answer.failure + "): no training, see mocaplm doctor";
  return answer.failure.empty() ? answer.json.value("line", "") : "LibTorch: " + answer.failure;
}

}  // namespace

std::string version_text() {
  return "mocaplm " MOCAPLM_VERSION "\ninstructions: " + to_string(kernel_level()) +
         " (generating)\nthreads: " + std::to_string(worker_count(0)) + "\n" + torch_line();
}

}  // namespace mocaplm
