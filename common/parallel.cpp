#include "common/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace mocaplm {

std::size_t worker_count(std::int64_t threads) {
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  return threads > 0 ? static_cast<std::size_t>(threads) : cores;
}

void parallel_for(std::size_t count, std::int64_t threads,
                  const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr error;
  std::size_t error_index = count;

  const auto worker = [&] {
    while (!stop) {
      const std::size_t index = next++;
      if (index >= count) return;
      try {
        work(index);
      } catch (...) {
        stop = true;
        const std::lock_guard<std::mutex> lock(mutex);
        if (index < error_index) {
          error = std::current_exception();
          error_index = index;
        }
      }
    }
  };
  std::vector<std::thread> others;
  const std::size_t workers = std::min(worker_count(threads), count);
  try {
    while (others.size() + 1 < workers) others.emplace_back(worker);
  } catch (const std::system_error&) {
    // No room for more threads: those that started, and this one, do the work.
  }
  worker();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace mocaplm
