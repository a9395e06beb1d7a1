// What a reader took for granted or found odd: said, not thrown.
#pragma once

#include <string>

namespace mocaplm {

// `kind` is the same for the same trouble in other files, so that many files give one message:
// "frames announced".
struct Remark {
  std::string kind;
  std::string text;  // a sentence without the file's name and without a full stop
};

}  // namespace mocaplm
