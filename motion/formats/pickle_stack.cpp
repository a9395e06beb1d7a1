// Input, stack and memo of the pickle machine.
#include <cstring>

#include "motion/formats/pickle_machine.h"

namespace mocaplm {

void PickleMachine::fail(const std::string& message) const {
  throw DataError(here(), message);
}

std::string_view PickleMachine::take(std::uint64_t count) {
  if (count > bytes_.size() - at_)
    throw DataError(at_byte(file_, bytes_.size()),
                    "the file ends inside the object that begins at byte " +
                        std::to_string(opcode_at_) + ": it is truncated or damaged");
  const std::string_view taken = bytes_.substr(at_, count);
  at_ += count;
  return taken;
}

std::uint64_t PickleMachine::little_endian(std::size_t count) {
  std::uint64_t value = 0;
  const std::string_view raw = take(count);
  for (std::size_t i = count; i > 0; --i)
    value = value << 8 | static_cast<unsigned char>(raw[i - 1]);
  return value;
}

double PickleMachine::big_endian_double() {
  std::uint64_t bits = 0;
  for (const char c : take(8)) bits = bits << 8 | static_cast<unsigned char>(c);
  double value;
  std::memcpy(&value, &bits, 8);
  return value;
}

std::string_view PickleMachine::counted(std::size_t count_bytes) {
  return take(little_endian(count_bytes));
}

std::string_view PickleMachine::line() {
  const std::size_t end = bytes_.substr(at_, 256).find('\n');
  if (end == std::string_view::npos) fail("a name does not end");
  const std::string_view text = take(end);
  take(1);
  return text;
}

PickleValue* PickleMachine::make(PickleKind kind) {
  if (pickle_.values_.size() >= kMaxPickleValues) fail("more than 1000000 objects");
  pickle_.values_.emplace_back();
  PickleValue& value = pickle_.values_.back();
  value.kind = kind;
  value.byte = opcode_at_;
  return &value;
}

void PickleMachine::push(PickleValue* value) {
  if (stack_.size() >= kMaxPickleStack) fail("more than 10000 objects on the stack");
  stack_.push_back(value);
}

PickleValue* PickleMachine::pop() {
  PickleValue* value = top();
  stack_.pop_back();
  return value;
}

PickleValue* PickleMachine::top() const {
  if (stack_.empty() || (!marks_.empty() && marks_.back() >= stack_.size()))
    fail("takes an object from an empty stack");
  return stack_.back();
}

std::vector<PickleValue*> PickleMachine::pop_to_mark() {
  if (marks_.empty()) fail("collects up to a mark that was never set");
  const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
  std::vector<PickleValue*> items(begin, stack_.end());
  stack_.erase(begin, stack_.end());
  marks_.pop_back();
  return items;
}

void PickleMachine::remember(std::uint64_t index) {
  memo_[index] = top();
  if (memo_.size() > kMaxPickleMemo) fail("more than 1000000 remembered objects");
}

void PickleMachine::recall(std::uint64_t index) {
  const auto found = memo_.find(index);
  if (found == memo_.end())
    fail("recalls object " + std::to_string(index) + ", which was never stored");
  push(found->second);
}

void PickleMachine::push_number(PickleKind kind, double number) {
  PickleValue* value = make(kind);
  value->number = number;
  push(value);
}

void PickleMachine::push_text(PickleKind kind, std::string_view text) {
  PickleValue* value = make(kind);
  value->text = text;
  push(value);
}

}  // namespace mocaplm
