// The page of a classifier's test: accuracies, what is taken for what, and the clips that it gets
// wrong, moving.
#pragma once

#include "classify/train.h"
#include "viewer/page.h"

namespace mocaplm {

// Clips are read from options.data; throws DataError when one of those shown cannot be read.
Page classification_page(const ClassifyOptions& options, const ClassifyResult& result);

}  // namespace mocaplm
