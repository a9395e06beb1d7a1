// What is hidden of a window: tokens that a masked model has to fill in, joints that augmentation
// takes away.
#pragma once

#include <vector>

#include "common/random.h"
#include "model/config.h"
#include "train/config.h"

namespace mocaplm {

struct WindowOptions {
  double condition_dropout = 0;  // share of condition tokens hidden
  double mask_share = 0.15;      // of a masked model's tokens
  double mask_spans = 0;    // share of windows in which joints and stretches are hidden instead
  double joint_subset = 0;  // share of windows that show some of the joints only
};

WindowOptions window_options(const TrainConfig& config);

// One flag for each of a window's `count` tokens from the start of a frame on: true where a masked
// model must fill in. Separators never are. Each bin is hidden with chance mask_share, at least one
// (thesis 4.5.2; BERT's unchanged and random tokens are left out, so that nothing that is asked for
// is shown). In a share mask_spans of the windows, a random subset of the joints (all of them in a
// third of these windows) is hidden over a random stretch of frames, each token of it with the
// chance cos(u pi / 2), u uniform (Chang et al., MaskGIT, 2022): what iterative filling meets.
std::vector<bool> draw_mask(const StreamShape& shape, std::size_t count,
                            const WindowOptions& options, Random& random);

// Channels that a window does not show (thesis 5.1): none, or with chance joint_subset those of a
// random number of joints, not all; the root's translation counts as one joint.
std::vector<bool> draw_hidden_channels(const StreamShape& shape, const WindowOptions& options,
                                       Random& random);

}  // namespace mocaplm
