// The threads that decode together. A token takes some forty steps of a few microseconds, each
// waiting for all threads: so they wait spinning, after a while with their core offered to
// others, and fall asleep only when no work comes.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace mocaplm {

class Team {
 public:
  // 0: one thread a core.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int size() const { return size_; }

  // Runs work(0) here and work(1) .. work(size - 1) on the other threads; returns when all have
  // ended. The work must not throw.
  void run(const std::function<void(int)>& work);
  // Within run, on every thread of the team: waits until all have come here.
  void barrier();

 private:
  void serve(int index);
  void await_work(std::uint64_t seen);

  int size_ = 1;
  std::vector<std::thread> threads_;
  const std::function<void(int)>* work_ = nullptr;
  std::atomic<std::uint64_t> run_{0};  // counts the calls of run
  std::atomic<bool> stop_{false};
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<std::uint64_t> passed_{0};  // counts the barriers
  std::mutex mutex_;
  std::condition_variable wake_;
  std::atomic<int> asleep_{0};
};

}  // namespace mocaplm
