#include "generate/kernels/cache.h"

#include <cmath>
#include <cstring>

#include "generate/kernels/linear.h"

namespace mocaplm {

namespace {

std::int64_t padded(std::int64_t value) {
  return (value + kLanes - 1) / kLanes * kLanes;
}

void put_half(std::uint32_t& word, std::int64_t half, float value) {
  const auto bits = static_cast<std::uint32_t>(to_bf16(value));
  word = half == 0 ? (word & 0xffff0000U) | bits : (word & 0xffffU) | bits << 16;
}

}  // namespace

KeyValueCache::KeyValueCache(std::int64_t sequences, std::int64_t heads, std::int64_t capacity,
                             std::int64_t width, Precision precision, Arena& arena)
    : halves_(precision != Precision::f32),
      heads_(heads),
      width_(width),
      padded_width_(padded(width)),
      padded_capacity_(padded(capacity)) {
  key_words_ = padded_capacity_ * (halves_ ? (width + 1) / 2 : width);
  value_words_ = padded_capacity_ * padded_width_ / (halves_ ? 2 : 1);
  words_ = arena.words(sequences * heads * (key_words_ + value_words_));
}

std::uint32_t* KeyValueCache::keys(std::int64_t sequence, std::int64_t head) const {
  return words_ + (sequence * heads_ + head) * (key_words_ + value_words_);
}

std::uint32_t* KeyValueCache::values(std::int64_t sequence, std::int64_t head) const {
  return keys(sequence, head) + key_words_;
}

std::int64_t KeyValueCache::bytes(std::int64_t count) const {
  return heads_ * 4 * (key_words_ + value_words_) * padded(count) / padded_capacity_;
}

void KeyValueCache::store(std::int64_t sequence, std::int64_t head, std::int64_t position,
                          const float* key, const float* value) {
  std::uint32_t *k = keys(sequence, head), *v = values(sequence, head);
  const std::int64_t depth = halves_ ? (width_ + 1) / 2 : width_;
  k += position / kLanes * depth * kLanes + position % kLanes;
  if (!halves_) {
    v += position * padded_width_;
    for (std::int64_t i = 0; i < width_; ++i) {
      std::memcpy(k + i * kLanes, key + i, sizeof(float));
      std::memcpy(v + i, value + i, sizeof(float));
    }
    return;
  }
  v += position / 2 * padded_width_;
  for (std::int64_t i = 0; i < width_; ++i) {
    put_half(k[i / 2 * kLanes], i % 2, key[i]);
    put_half(v[i], position % 2, value[i]);
  }
}

void KeyValueCache::attend(std::int64_t sequence, std::int64_t head, std::int64_t count,
                           const float* query, float* scratch, float* out) const {
  float *scaled = scratch + padded_capacity_, scale = 1 / std::sqrt(static_cast<float>(width_));
  for (std::int64_t i = 0; i < width_; ++i) scaled[i] = query[i] * scale;
  const Kernels& k = kernels();
  (halves_ ? k.attend_bf16 : k.attend_f32)(scaled, keys(sequence, head), values(sequence, head),
                                           count, width_, scratch, out);
}

}  // namespace mocaplm
