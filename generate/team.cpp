#include "generate/team.h"

#include <sched.h>

#include <algorithm>
#include <system_error>

namespace mocaplm {

namespace {

constexpr int kSpins = 4000;      // some 50 microseconds
constexpr int kShortSpins = 100;  // some 2 microseconds: most waits at a barrier end before

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

// The more often it was called the less it keeps its core: when another program has one of them,
// two of the team's threads are on the same, and a wait must not keep out the thread that it waits
// for.
void wait_a_little(int spins) {
  if (spins < kShortSpins || spins % 16 != 0)
    pause();
  else
    ::sched_yield();
}

}  // namespace

Team::Team(int threads)
    : size_(threads > 0 ? threads
                        : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {
  for (int i = 1; i < size_; ++i) {
    try {
      threads_.emplace_back([this, i] { serve(i); });
    } catch (const std::system_error&) {  // no memory or no right to so many: fewer will do
      size_ = i;
    }
  }
}

Team::~Team() {
  stop_ = true;
  run([](int) {});
  for (std::thread& thread : threads_) thread.join();
}

void Team::run(const std::function<void(int)>& work) {
  work_ = &work;
  run_.fetch_add(1);
  // Sequentially consistent: whoever goes to sleep counts itself before it looks at run_ again.
  if (asleep_.load() > 0) {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_.notify_all();
  }
  work(0);
  barrier();
}

void Team::await_work(std::uint64_t seen) {
  for (int spins = 0; spins < kSpins; ++spins) {
    if (run_.load(std::memory_order_acquire) != seen) return;
    wait_a_little(spins);
  }
  std::unique_lock<std::mutex> lock(mutex_);
  asleep_.fetch_add(1);
  wake_.wait(lock, [&] { return run_.load() != seen; });
  asleep_.fetch_sub(1);
}

void Team::serve(int index) {
  for (std::uint64_t seen = 0;; ++seen) {
    await_work(seen);
    (*work_)(index);
    const bool last = stop_.load();
    barrier();
    if (last) return;
  }
}

void Team::barrier() {
  if (size_ == 1) return;
  const std::uint64_t before = passed_.load(std::memory_order_relaxed);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == size_) {
    arrived_.store(0, std::memory_order_relaxed);
    passed_.store(before + 1, std::memory_order_release);
    return;
  }
  for (int spins = 0; passed_.load(std::memory_order_acquire) == before; ++spins) {
    wait_a_little(spins);
  }
}

}  // namespace mocaplm
