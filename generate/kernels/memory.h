// Memory for what decoding streams through at every token: aligned, in large pages where the system
// has them, never copied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace mocaplm {

// Hands out zeroed pieces of large blocks; all are freed together.
class Arena {
 public:
  // `count` words of 32 bits, aligned to 64 bytes.
  std::uint32_t* words(std::int64_t count);

 private:
  struct Free {
    void operator()(void* block) const;
  };
  std::vector<std::unique_ptr<void, Free>> blocks_;
  std::byte* next_ = nullptr;
  std::size_t left_ = 0;
};

}  // namespace mocaplm
