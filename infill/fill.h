// Filling hidden tokens of a stream with a masked model, the most confident ones first (as
// Ghazvininejad et al., "Mask-predict", 2019, and Chang et al., "MaskGIT", 2022).
#pragma once

#include <functional>
#include <vector>

#include "infill/config.h"
#include "model/transformer/language_model.h"

namespace mocaplm {

// `ids`: whole frames; bins that are hidden hold the mask token `mask`, and get one of the first
// channel_bins[channel] bins each. `prefix`: start and condition tokens. After round r of R,
// cos(pi r / 2R) of them are still hidden. A stream longer than the context is seen in windows that
// overlap by half, each token from the one in whose middle it lies. `round_done` is called with the
// number of rounds done. Returns the stream with nothing hidden.
std::vector<std::int32_t> fill_hidden(
    LanguageModel& model, const std::vector<std::int32_t>& prefix, std::vector<std::int32_t> ids,
    std::int32_t mask, const std::vector<int>& channel_bins, const FillOptions& options,
    const std::function<void(std::int64_t)>& round_done = nullptr);

}  // namespace mocaplm
