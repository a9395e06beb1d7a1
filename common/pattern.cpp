#include "common/pattern.h"

#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <regex>

#include "common/error.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxExpression = 1000;
constexpr std::size_t kMaxText = 1000;
constexpr int kMaxGroups = 12;
constexpr std::size_t kMaxSteps = 20'000'000;

struct TooManySteps {};

// What one search may use. std::regex recurses for every character, so the stack is watched too.
class Budget {
 public:
  void spend() {
    const char* here = static_cast<const char*>(__builtin_frame_address(0));
    if (++steps_ > kMaxSteps || std::abs(start_ - here) > stack_) throw TooManySteps();
  }
  // For reading what was found.
  void refill() { steps_ = 0; }

 private:
  static std::ptrdiff_t half_the_stack() {
    constexpr rlim_t kUsual = rlim_t{8} << 20;
    rlimit limit{};
    const bool known = ::getrlimit(RLIMIT_STACK, &limit) == 0;
    return static_cast<std::ptrdiff_t>(std::min(known ? limit.rlim_cur : kUsual, kUsual) / 2);
  }

  std::size_t steps_ = 0;
  const char* start_ = static_cast<const char*>(__builtin_frame_address(0));
  std::ptrdiff_t stack_ = half_the_stack();
};

// Walks over the text and counts how often the engine looks at it: std::regex backtracks, and this
// is the only place where it can be stopped.
class CountingIterator {
 public:
  using iterator_category = std::bidirectional_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator() = default;
  CountingIterator(const char* at, Budget* budget) : at_(at), budget_(budget) {}
  reference operator*() const {
    count();
    return *at_;
  }
  CountingIterator& operator++() { return ++at_, *this; }
  CountingIterator operator++(int) { return {at_++, budget_}; }
  CountingIterator& operator--() { return --at_, *this; }
  CountingIterator operator--(int) { return {at_--, budget_}; }
  bool operator==(const CountingIterator& other) const {
    count();
    return at_ == other.at_;
  }
  bool operator!=(const CountingIterator& other) const { return !(*this == other); }

 private:
  void count() const {
    if (budget_ != nullptr) budget_->spend();
  }
  const char* at_ = nullptr;
  Budget* budget_ = nullptr;
};

}  // namespace

struct Pattern::State {
  std::string expression, option;
  std::regex regex;
  std::vector<std::string> group_names;  // "" for groups without a name

  [[noreturn]] void fail(const std::string& message) const {
    throw UsageError(option + " \"" + expression.substr(0, 100) + "\": " + message);
  }

  std::string read_name(std::size_t& at) const {
    const std::size_t end = expression.find('>', at);
    if (end == std::string::npos) fail("a group's name is not closed by '>'");
    const std::string name = expression.substr(at, end - at);
    const bool good = std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (name.empty() || !good)
      fail("\"" + name + "\" is not a group's name (letters, digits, _ and -)");
    if (std::count(group_names.begin(), group_names.end(), name) > 0)
      fail("the group \"" + name + "\" is there twice");
    at = end + 1;
    return name;
  }

  // std::regex knows no named groups: they become plain ones and their names are kept here.
  std::string translate() {
    std::string plain;
    int depth = 0;
    bool in_class = false;
    for (std::size_t i = 0; i < expression.size();) {
      const char c = expression[i];
      if (c == '\\' && i + 1 < expression.size()) {
        if (expression[i + 1] >= '1' && expression[i + 1] <= '9')
          fail("back-references such as \\1 are not supported");
        plain += expression.substr(i, 2);
        i += 2;
        continue;
      }
      if (c == '[') in_class = true;
      if (c == ']') in_class = false;
      plain += c;
      ++i;
      if (in_class || c == ']') continue;
      if (c == ')') --depth;
      if (c == '(') {
        if (++depth > kMaxGroups) fail("groups are nested too deep");
        open_group(i);
      }
    }
    return plain;
  }

  // `i` stands behind an opening parenthesis; moves behind "?<name>".
  void open_group(std::size_t& i) {
    std::size_t start = 0;
    if (expression.compare(i, 3, "?P<") == 0) start = i + 3;
    if (expression.compare(i, 2, "?<") == 0) start = i + 2;
    if (start > 0 && start < expression.size() &&
        (expression[start] == '=' || expression[start] == '!'))
      fail("looking behind, (?<= and (?<!, is not supported");
    if (start > 0) {
      i = start;
      group_names.push_back(read_name(i));
    } else if (i >= expression.size() || expression[i] != '?') {
      group_names.emplace_back();
    }
  }
};

Pattern::Pattern(const std::string& expression, const std::string& option)
    : state_(std::make_unique<State>()) {
  state_->expression = expression;
  state_->option = option;
  if (expression.empty()) state_->fail("expected a regular expression");
  if (expression.size() > kMaxExpression) state_->fail("is longer than 1000 characters");
  try {
    state_->regex = std::regex(state_->translate(), std::regex::ECMAScript);
  } catch (const std::regex_error& error) {
    state_->fail(std::string("not a regular expression: ") + error.what());
  }
}

Pattern::~Pattern() = default;
Pattern::Pattern(Pattern&&) noexcept = default;

std::optional<Pattern::Match> Pattern::search(const std::string& text) const {
  if (text.size() > kMaxText)
    state_->fail("cannot be tried on a text of more than 1000 characters");
  Budget budget;
  std::match_results<CountingIterator> found;
  try {
    const char* begin = text.data();
    if (!std::regex_search(CountingIterator(begin, &budget),
                           CountingIterator(begin + text.size(), &budget), found, state_->regex))
      return std::nullopt;
  } catch (const TooManySteps&) {
    state_->fail("takes too long on \"" + text.substr(0, 100) +
                 "\"; avoid repeats inside repeats such as (a+)+");
  } catch (const std::regex_error& error) {
    state_->fail(std::string("fails on \"") + text.substr(0, 100) + "\": " + error.what());
  }
  budget.refill();
  Match match;
  match.whole = found[0].str();
  for (std::size_t g = 0; g < state_->group_names.size() && g + 1 < found.size(); ++g) {
    match.groups.push_back(found[g + 1].matched ? found[g + 1].str() : "");
    if (found[g + 1].matched && !state_->group_names[g].empty())
      match.named.emplace_back(state_->group_names[g], match.groups.back());
  }
  return match;
}

std::vector<std::string> Pattern::names() const {
  std::vector<std::string> names;
  for (const std::string& name : state_->group_names)
    if (!name.empty()) names.push_back(name);
  return names;
}

}  // namespace mocaplm
