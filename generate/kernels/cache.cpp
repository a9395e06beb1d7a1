#include "generate/kernels/cache.h"

#include <algorithm>
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

std::int64_t values_a_word(Precision precision) {
  if (precision == Precision::f32) return 1;
  return precision == Precision::int8 && kernels().attend_int8 != nullptr ? 4 : 2;
}

}  // namespace

KeyValueCache::KeyValueCache(std::int64_t sequences, std::int64_t heads, std::int64_t capacity,
                             std::int64_t width, Precision precision, Arena& arena)
    : packed_(values_a_word(precision)),
      heads_(heads),
      width_(width),
      padded_width_(padded(width)),
      padded_capacity_(padded(capacity)) {
  depth_ = (width + packed_ - 1) / packed_;
  key_words_ = padded_capacity_ * depth_;
  value_words_ = padded_capacity_ * padded_width_ / packed_;
  head_words_ = key_words_ + value_words_ + (packed_ == 4 ? 3 * padded_capacity_ : 0);
  words_ = arena.words(sequences * heads * head_words_);
}

std::uint32_t* KeyValueCache::keys(std::int64_t sequence, std::int64_t head) const {
  return words_ + (sequence * heads_ + head) * head_words_;
}

std::uint32_t* KeyValueCache::values(std::int64_t sequence, std::int64_t head) const {
  return keys(sequence, head) + key_words_;
}

float* KeyValueCache::key_scales(std::int64_t sequence, std::int64_t head) const {
  return reinterpret_cast<float*>(values(sequence, head) + value_words_);
}

ByteHead KeyValueCache::byte_head(std::int64_t sequence, std::int64_t head) const {
  float* scales = key_scales(sequence, head);
  return {keys(sequence, head), values(sequence, head), scales, scales + padded_capacity_,
          reinterpret_cast<std::int32_t*>(scales + 2 * padded_capacity_)};
}

std::int64_t KeyValueCache::bytes(std::int64_t count) const {
  return heads_ * 4 * head_words_ * padded(count) / padded_capacity_;
}

void KeyValueCache::store(std::int64_t sequence, std::int64_t head, std::int64_t position,
                          const float* key, const float* value) {
  if (packed_ == 4)
    return kernels().put_int8(key, value, width_, position, byte_head(sequence, head));
  std::uint32_t *k = keys(sequence, head), *v = values(sequence, head);
  k += position / kLanes * depth_ * kLanes + position % kLanes;
  v += position / packed_ * padded_width_;
  for (std::int64_t i = 0; i < width_; ++i) {
    if (packed_ == 1) {
      std::memcpy(k + i * kLanes, key + i, sizeof(float));
      std::memcpy(v + i, value + i, sizeof(float));
    } else {
      put_half(k[i / 2 * kLanes], i % 2, key[i]);
      put_half(v[i], position % 2, value[i]);
    }
  }
}

void KeyValueCache::list(std::int64_t sequence, std::int64_t head, std::int64_t count,
                         std::vector<Piece>& pieces) const {
  const auto add = [&](const void* from, std::int64_t words) {
    const auto* begin = static_cast<const char*>(from);
    pieces.push_back({begin, begin + 4 * words});
  };
  const std::int64_t all = padded(count);
  const ByteHead bytes = byte_head(sequence, head);
  if (packed_ == 4) add(bytes.key_offset, all), add(bytes.key_scale, all);
  add(bytes.keys, all * depth_);
  if (packed_ == 4) add(bytes.value_scale, all);
  add(bytes.values, all * padded_width_ / packed_);
}

void KeyValueCache::attend(std::int64_t sequence, std::int64_t head, std::int64_t count,
                           const float* query, float* scratch, float* out, Ahead* ahead) const {
  // The query comes behind what the kernels take.
  float *scaled = scratch + scratch_size() - padded_width_,
        scale = 1 / std::sqrt(static_cast<float>(width_));
  for (std::int64_t i = 0; i < width_; ++i) scaled[i] = query[i] * scale;
  const Kernels& k = kernels();
  const std::uint32_t *key_words = keys(sequence, head), *value_words = values(sequence, head);
  Ahead nothing;
  Ahead& next = ahead != nullptr ? *ahead : nothing;
  if (packed_ == 4)
    k.attend_int8(scaled, byte_head(sequence, head), count, width_, scratch, out, next);
  else if (packed_ == 2)
    k.attend_bf16(scaled, key_words, value_words, count, width_, scratch, out, next);
  else
    k.attend_f32(scaled, key_words, value_words, count, width_, scratch, out);
}

}  // namespace mocaplm
