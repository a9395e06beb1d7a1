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
          reinterpret_cast<const std::int32_t*>(scales + 2 * padded_capacity_)};
}

std::int64_t KeyValueCache::bytes(std::int64_t count) const {
  return heads_ * 4 * head_words_ * padded(count) / padded_capacity_;
}

void KeyValueCache::store(std::int64_t sequence, std::int64_t head, std::int64_t position,
                          const float* key, const float* value) {
  if (packed_ == 4) return store_bytes(sequence, head, position, key, value);
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

void KeyValueCache::store_bytes(std::int64_t sequence, std::int64_t head, std::int64_t position,
                                const float* key, const float* value) {
  const auto scale_of = [&](const float* x) {
    float top = 0;
    for (std::int64_t i = 0; i < width_; ++i) top = std::max(top, std::abs(x[i]));
    return top / 127;
  };
  float* scales = key_scales(sequence, head);
  const float key_scale = scale_of(key), value_scale = scale_of(value);
  scales[position] = key_scale;
  scales[padded_capacity_ + position] = value_scale;
  const float to_key = key_scale > 0 ? 1 / key_scale : 0,
              to_value = value_scale > 0 ? 1 / value_scale : 0;
  auto* k = reinterpret_cast<std::int8_t*>(keys(sequence, head) +
                                           position / kLanes * depth_ * kLanes + position % kLanes);
  auto* v = reinterpret_cast<std::int8_t*>(values(sequence, head) + position / 4 * padded_width_) +
            position % 4;
  std::int32_t sum = 0;
  for (std::int64_t i = 0; i < width_; ++i) {
    const auto byte = static_cast<std::int8_t>(std::nearbyint(key[i] * to_key));
    k[i / 4 * kLanes * 4 + i % 4] = byte;
    sum += byte;
    v[4 * i] = static_cast<std::int8_t>(std::nearbyint(value[i] * to_value));
  }
  sum *= 128;
  std::memcpy(scales + 2 * padded_capacity_ + position, &sum, sizeof sum);
}

void KeyValueCache::attend(std::int64_t sequence, std::int64_t head, std::int64_t count,
                           const float* query, float* scratch, float* out) const {
  // The query comes behind what the kernels take.
  float *scaled = scratch + scratch_size() - padded_width_,
        scale = 1 / std::sqrt(static_cast<float>(width_));
  for (std::int64_t i = 0; i < width_; ++i) scaled[i] = query[i] * scale;
  const Kernels& k = kernels();
  if (packed_ == 4)
    return k.attend_int8(scaled, byte_head(sequence, head), count, width_, scratch, out);
  (packed_ == 2 ? k.attend_bf16 : k.attend_f32)(
      scaled, keys(sequence, head), values(sequence, head), count, width_, scratch, out);
}

}  // namespace mocaplm
