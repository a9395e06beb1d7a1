// Independent pieces of work spread over all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace mocaplm {

// The number of workers for a `--threads` option: the machine's cores when it is 0.
std::size_t worker_count(std::int64_t threads);

// Calls work(0) ... work(count - 1), each once, from up to `threads` workers (0: all cores);
// indices are taken in ascending order. After an exception no further index is started, and the
// exception of the lowest index is thrown again when all workers have stopped.
void parallel_for(std::size_t count, std::int64_t threads,
                  const std::function<void(std::size_t)>& work);

}  // namespace mocaplm
