// How often the clips of each value of a label are drawn: small collections beside large ones.
#pragma once

#include <string>

#include "train/corpus.h"

namespace mocaplm {

// Weighs the clips so that a value of `label` whose clips have f frames in all is drawn with a
// chance proportional to f^(1 - share): as the corpus has it for 0, all values alike for 1. Among
// the clips of a value nothing changes. Clips without the label count as one value more.
void balance(Corpus& corpus, const std::string& label, double share);

}  // namespace mocaplm
