// Gradients of weights: sums over the tokens, whose rows are interleaved in pairs block by block.
#include "model/transformer/cpu/block_parts_avx512.h"

namespace mocaplm::cpu::avx512 {

namespace {

constexpr std::int64_t kTokens = 512;  // of a block: with 512 columns it fills half of the L2

// sums (64) += the columns of what interleave wrote with 64 columns.
void add_columns(const bf16* pairs_of, std::int64_t pairs_count, float* sums) {
  for (std::int64_t c = 0; c < kPanel; c += kLanes) {
    __m512 sum = _mm512_loadu_ps(sums + c);
    for (std::int64_t k = 0; k < pairs_count; ++k) {
      const __m512bh two = pairs(pairs_of + (k * kPanel + c) * 2);
      sum = _mm512_dpbf16_ps(sum, two, (__m512bh)_mm512_set1_epi16(0x3f80));  // times 1
    }
    _mm512_storeu_ps(sums + c, sum);
  }
}

struct Gradient {
  const bf16* dy;
  std::int64_t stride;
  const bf16* x;
  std::int64_t tokens, rows, columns;
  float *dw, *db;

  // Rows `first` to `last`, in panels of 64, of the columns from `column` on.
  void part(std::int64_t column, std::int64_t first, std::int64_t last) const {
    Scratch scratch(Scratch::bytes(kTokens * (kPanel + kGradientColumns), 2));
    bf16* left = scratch.halves(kTokens * kPanel);
    bf16* right = scratch.halves(kTokens * kGradientColumns);
    const std::int64_t width =
        columns - column < kGradientColumns ? columns - column : kGradientColumns;
    const std::int64_t strips = (width + kPanel - 1) / kPanel;
    for (std::int64_t t = 0; t < tokens; t += kTokens) {
      const std::int64_t some = tokens - t < kTokens ? tokens - t : kTokens;
      const std::int64_t pair_count = (some + 1) / 2;
      for (std::int64_t panel = first; panel < last; ++panel) {
        const std::int64_t row = panel * kPanel;
        const std::int64_t there = rows - row < kPanel ? rows - row : kPanel;
        interleave(dy + t * stride + row, stride, some, there, kPanel, left);
        if (column == 0) add_bias(left, pair_count, row, there, t > 0);
        const Strip next = panel + 1 < last ? Strip{dy + t * stride + row + kPanel, stride, some}
                                            : Strip{dy + (t + some) * stride + first * kPanel,
                                                    stride, tokens - t - some};
        for (std::int64_t strip = 0; strip < strips; ++strip) {
          const std::int64_t c = strip * kPanel, wide = width - c < kPanel ? width - c : kPanel;
          const bf16* from = x + t * columns + column + c;
          if (panel == first) interleave(from, columns, some, wide, wide, right + c * kTokens);
          // What is to be interleaved next: strips of x while those are still coming, else a share
          // of the next panel of dy.
          const bool coming = panel == first && strip + 1 < strips;
          multiply({left, 2, 2 * kPanel}, there, wide, right + c * kTokens, pair_count,
                   dw + row * columns + column + c, t > 0,
                   coming ? Strip{from + kPanel, columns, some} : next.share(strip, strips));
        }
      }
    }
  }

  // Rows of 64 values.
  struct Strip {
    const bf16* data;
    std::int64_t stride, rows;

    Strip share(std::int64_t part, std::int64_t parts) const {
      const std::int64_t all = rows < kTokens ? rows : kTokens, begin = all * part / parts;
      return {data + begin * stride, stride, all * (part + 1) / parts - begin};
    }
  };

  // A panel of the product; between its tiles `ahead` is fetched.
  void multiply(const Left& a, std::int64_t there, std::int64_t wide, const bf16* b,
                std::int64_t pair_count, float* c, bool add, const Strip& ahead) const {
    constexpr std::int64_t kTile = 6;
    const std::int64_t tiles = (there + kTile - 1) / kTile;
    for (std::int64_t tile = 0; tile < tiles; ++tile) {
      const Strip now = ahead.share(tile, tiles);
      for (std::int64_t i = 0; i < now.rows; ++i) fetch(now.data + i * now.stride, 2 * kPanel);
      const std::int64_t r = tile * kTile, some = there - r < kTile ? there - r : kTile;
      panel_product({a.data + r * a.row, a.row, a.pair}, some, wide, b, pair_count, c + r * columns,
                    columns, add);
    }
  }

  void add_bias(const bf16* left, std::int64_t pair_count, std::int64_t row, std::int64_t there,
                bool add) const {
    float sums[kPanel] = {};
    if (add) std::memcpy(sums, db + row, static_cast<std::size_t>(there) * sizeof(float));
    add_columns(left, pair_count, sums);
    std::memcpy(db + row, sums, static_cast<std::size_t>(there) * sizeof(float));
  }
};

}  // namespace

void weight_gradient(const bf16* dy, std::int64_t stride, const bf16* x, std::int64_t tokens,
                     std::int64_t rows, std::int64_t columns, float* dw, float* db,
                     std::int64_t first, std::int64_t last) {
  const Gradient gradient{dy, stride, x, tokens, rows, columns, dw, db};
  const std::int64_t panels = (rows + kPanel - 1) / kPanel;
  for (std::int64_t task = first; task < last;) {
    const std::int64_t chunk = task / panels, panel = task % panels;
    const std::int64_t end = last - task < panels - panel ? last - task : panels - panel;
    gradient.part(chunk * kGradientColumns, panel, panel + end);
    task += end;
  }
}

}  // namespace mocaplm::cpu::avx512
