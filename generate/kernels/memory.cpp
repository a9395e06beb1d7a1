#include "generate/kernels/memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

namespace mocaplm {

namespace {

constexpr std::size_t kLine = 64, kLargePage = std::size_t{2} << 20, kBlock = 4 * kLargePage;

std::size_t round_up(std::size_t size, std::size_t step) {
  return (size + step - 1) / step * step;
}

}  // namespace

void Arena::Free::operator()(void* block) const {
  std::free(block);
}

std::uint32_t* Arena::words(std::int64_t count) {
  const std::size_t size = round_up(static_cast<std::size_t>(count) * sizeof(std::uint32_t), kLine);
  if (size > left_) {
    const std::size_t block = round_up(std::max(size, kBlock), kLargePage);
    void* memory = std::aligned_alloc(kLargePage, block);
    if (memory == nullptr) throw std::bad_alloc();
    blocks_.emplace_back(memory);
#if defined(MADV_HUGEPAGE)
    ::madvise(memory, block, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
#endif
    next_ = static_cast<std::byte*>(memory);
    left_ = block;
  }
  std::byte* piece = next_;
  next_ += size;
  left_ -= size;
  std::memset(piece, 0, size);
  return reinterpret_cast<std::uint32_t*>(piece);
}

}  // namespace mocaplm
