// What was meant by a name that is not known. Messages are made by did_you_mean and known_names
// (common/text.h).
#pragma once

#include <string>
#include <vector>

namespace mocaplm {

// Fewest changes that make a word of another: a letter more, less or another, two neighbours
// exchanged (Damerau and Levenshtein's distance, no letter changed twice).
std::size_t edit_distance(const std::string& a, const std::string& b);

// The nearest candidate, upper and lower case alike, if so few changes are a slip of the hand: one
// in words of up to 4 letters, two in words of up to 7, then a third of the letters. Else the only
// one that begins with the word. Else "".
std::string nearest_name(const std::string& given, const std::vector<std::string>& candidates);

}  // namespace mocaplm
