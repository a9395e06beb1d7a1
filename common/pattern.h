// Regular expressions from the command line, with named groups: (?<content>[a-z-]+) or
// (?P<content>...).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mocaplm {

class Pattern {
 public:
  // ECMAScript syntax. Throws UsageError, speaking of `option`, for what cannot be read, is longer
  // than 1000 characters or nested deeper than 12 groups, or names a group twice.
  Pattern(const std::string& expression, const std::string& option);
  ~Pattern();
  Pattern(Pattern&&) noexcept;

  struct Match {
    std::string whole;
    std::vector<std::string> groups;  // in order, "" for those that took no part
    std::vector<std::pair<std::string, std::string>> named;  // only those that took part
  };

  // The first place in `text` where it matches. Throws UsageError when the search takes too many
  // steps (as "(a+)+$" does) or the text has more than 1000 characters.
  std::optional<Match> search(const std::string& text) const;
  // The names of its named groups.
  std::vector<std::string> names() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mocaplm
