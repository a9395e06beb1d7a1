#include "motion/formats/pickle_machine.h"

#include <cstdio>

namespace mocaplm {

namespace {

// The opcodes that are read. Values: Python's Lib/pickletools.py.
enum Opcode : unsigned char {
  kMark = '(',
  kStop = '.',
  kProto = 0x80,
  kFrame = 0x95,
  kNone = 'N',
  kTrue = 0x88,
  kFalse = 0x89,
  kBinInt = 'J',
  kBinInt1 = 'K',
  kBinInt2 = 'M',
  kLong1 = 0x8a,
  kBinFloat = 'G',
  kBinUnicode = 'X',
  kShortBinUnicode = 0x8c,
  kBinUnicode8 = 0x8d,
  kBinBytes = 'B',
  kShortBinBytes = 'C',
  kBinBytes8 = 0x8e,
  kByteArray8 = 0x96,
  kBinString = 'T',
  kShortBinString = 'U',
  kEmptyTuple = ')',
  kTuple = 't',
  kTuple1 = 0x85,
  kTuple2 = 0x86,
  kTuple3 = 0x87,
  kEmptyList = ']',
  kAppend = 'a',
  kAppends = 'e',
  kEmptyDict = '}',
  kSetItem = 's',
  kSetItems = 'u',
  kBinPut = 'q',
  kLongBinPut = 'r',
  kMemoize = 0x94,
  kBinGet = 'h',
  kLongBinGet = 'j',
  kGlobal = 'c',
  kStackGlobal = 0x93,
  kReduce = 'R',
  kNewObject = 0x81,
  kPersistentId = 'Q',
  kPop = '0',
  kEmptySet = 0x8f,
  kAddItems = 0x90,
  kBuild = 'b'
};

struct Refused {
  unsigned char opcode;
  const char* name;
};
constexpr Refused kRefused[] = {{'1', "POP_MARK"},
                                {'2', "DUP"},
                                {'F', "FLOAT"},
                                {'I', "INT"},
                                {'L', "LONG"},
                                {'P', "PERSID"},
                                {'Q', "BINPERSID"},
                                {'S', "STRING"},
                                {'V', "UNICODE"},
                                {'d', "DICT"},
                                {'g', "GET"},
                                {'i', "INST"},
                                {'l', "LIST"},
                                {'o', "OBJ"},
                                {'p', "PUT"},
                                {0x82, "EXT1"},
                                {0x83, "EXT2"},
                                {0x84, "EXT4"},
                                {0x8b, "LONG4"},
                                {0x91, "FROZENSET"},
                                {0x92, "NEWOBJ_EX"},
                                {0x97, "NEXT_BUFFER"},
                                {0x98, "READONLY_BUFFER"}};

std::string opcode_name(unsigned char opcode) {
  char hex[8];
  std::snprintf(hex, sizeof hex, "0x%02x", opcode);
  for (const Refused& refused : kRefused)
    if (refused.opcode == opcode) return std::string(refused.name) + " (" + hex + ")";
  return hex;
}

}  // namespace

PickleValue* PickleMachine::run() {
  if (bytes_.empty()) fail("the file is empty");
  if (static_cast<unsigned char>(bytes_[0]) != kProto)
    fail("is not a pickle of protocol 2 or newer: it does not begin with 0x80");
  for (;;) {
    opcode_at_ = at_;
    const auto opcode = static_cast<unsigned char>(take(1)[0]);
    if (opcode == kStop) break;
    if (opcode == kProto) {
      const std::uint64_t protocol = little_endian(1);
      if (protocol < 2 || protocol > 5)
        fail("pickle protocol " + std::to_string(protocol) + ", expected 2 to 5");
    } else if (opcode == kFrame) {
      if (little_endian(8) > bytes_.size() - at_)
        fail("a frame is longer than the file: the file is truncated or damaged");
    } else if (!run_atom(opcode) && !run_container(opcode) && !run_memo(opcode) &&
               !run_object(opcode)) {
      fail("refuses the pickle opcode " + opcode_name(opcode) +
           ": motion files need no such thing, and nothing in a pickle is executed");
    }
  }
  if (stack_.size() != 1 || !marks_.empty())
    fail("the pickle stops with " + std::to_string(stack_.size()) + " objects, expected one");
  return stack_[0];
}

bool PickleMachine::run_atom(unsigned char opcode) {
  switch (opcode) {
    case kNone:
      push(make(PickleKind::none));
      return true;
    case kTrue:
      push_number(PickleKind::boolean, 1);
      return true;
    case kFalse:
      push_number(PickleKind::boolean, 0);
      return true;
    case kBinInt: {
      const auto bits = static_cast<std::uint32_t>(little_endian(4));
      push_number(PickleKind::integer, static_cast<std::int32_t>(bits));
      return true;
    }
    case kBinInt1:
      push_number(PickleKind::integer, static_cast<double>(little_endian(1)));
      return true;
    case kBinInt2:
      push_number(PickleKind::integer, static_cast<double>(little_endian(2)));
      return true;
    case kLong1: {
      const std::uint64_t count = little_endian(1);
      if (count > 8 && depth_ > 0 && count <= 16) {  // PyTorch's magic number
        take(count);
        push_number(PickleKind::integer, 0);
        return true;
      }
      if (count > 8) fail("a whole number of " + std::to_string(count) + " bytes, more than 8");
      const std::uint64_t bits = little_endian(count);
      const std::uint64_t unused = 64 - 8 * count;
      const std::int64_t value =
          count == 0 ? 0 : static_cast<std::int64_t>(bits << unused) >> unused;
      push_number(PickleKind::integer, static_cast<double>(value));
      return true;
    }
    case kBinFloat:
      push_number(PickleKind::number, big_endian_double());
      return true;
    case kBinUnicode:
      push_text(PickleKind::text, counted(4));
      return true;
    case kShortBinUnicode:
      push_text(PickleKind::text, counted(1));
      return true;
    case kBinUnicode8:
      push_text(PickleKind::text, counted(8));
      return true;
    case kBinBytes:
    case kBinString:
      push_text(PickleKind::bytes, counted(4));
      return true;
    case kShortBinBytes:
    case kShortBinString:
      push_text(PickleKind::bytes, counted(1));
      return true;
    case kBinBytes8:
    case kByteArray8:
      push_text(PickleKind::bytes, counted(8));
      return true;
    default:
      return false;
  }
}

bool PickleMachine::run_container(unsigned char opcode) {
  switch (opcode) {
    case kMark:
      if (marks_.size() >= kMaxPickleStack) fail("marks nested more than 10000 deep");
      marks_.push_back(stack_.size());
      return true;
    case kEmptyTuple:
      push(make(PickleKind::tuple));
      return true;
    case kEmptyList:
    case kEmptySet:  // nobody asks for its order
      push(make(PickleKind::list));
      return true;
    case kEmptyDict:
      push(make(PickleKind::dictionary));
      return true;
    case kTuple: {
      PickleValue* tuple = make(PickleKind::tuple);
      tuple->items = pop_to_mark();
      push(tuple);
      return true;
    }
    case kTuple1:
    case kTuple2:
    case kTuple3: {
      PickleValue* tuple = make(PickleKind::tuple);
      tuple->items.resize(static_cast<std::size_t>(opcode - kTuple1) + 1);
      for (std::size_t i = tuple->items.size(); i > 0; --i) tuple->items[i - 1] = pop();
      push(tuple);
      return true;
    }
    case kAppend:
    case kSetItem:
    case kAppends:
    case kAddItems:
    case kSetItems: {
      const bool list = opcode != kSetItem && opcode != kSetItems;
      std::vector<PickleValue*> items;
      if (opcode == kAppend || opcode == kSetItem) {
        items.resize(list ? 1 : 2);
        for (std::size_t i = items.size(); i > 0; --i) items[i - 1] = pop();
      } else {
        items = pop_to_mark();
      }
      PickleValue& into = *top();
      if (into.kind != (list ? PickleKind::list : PickleKind::dictionary))
        fail(std::string(list ? "appends to " : "sets an item of ") + describe(into));
      if (!list && items.size() % 2 != 0) fail("sets a dictionary key without a value");
      if (into.items.size() + items.size() > kMaxPickleValues)
        fail("a list of more than 1000000 items");
      into.items.insert(into.items.end(), items.begin(), items.end());
      return true;
    }
    default:
      return false;
  }
}

bool PickleMachine::run_memo(unsigned char opcode) {
  switch (opcode) {
    case kBinPut:
      remember(little_endian(1));
      return true;
    case kLongBinPut:
      remember(little_endian(4));
      return true;
    case kMemoize:
      remember(memo_.size());
      return true;
    case kBinGet:
      recall(little_endian(1));
      return true;
    case kLongBinGet:
      recall(little_endian(4));
      return true;
    case kPop:
      pop();
      return true;
    default:
      return false;
  }
}

bool PickleMachine::run_object(unsigned char opcode) {
  switch (opcode) {
    case kGlobal: {
      const std::string_view module = line();
      push_global(module, line());
      return true;
    }
    case kStackGlobal: {
      const PickleValue *name = pop(), *module = pop();
      if (name->kind != PickleKind::text || module->kind != PickleKind::text)
        fail("names a global by " + describe(*module) + " and " + describe(*name));
      push_global(module->text, name->text);
      return true;
    }
    case kReduce: {
      const PickleValue *arguments = pop(), *function = pop();
      call(*function, *arguments);
      return true;
    }
    case kNewObject: {
      const PickleValue *arguments = pop(), *type = pop();
      if (arguments->kind != PickleKind::tuple)
        fail("makes an object with " + describe(*arguments));
      make_object(*type);
      return true;
    }
    case kPersistentId: {
      const bool known = pickle_.load_ != nullptr || depth_ > 0;
      if (!known) return false;
      load_storage(*pop());
      return true;
    }
    case kBuild: {
      const PickleValue* state = pop();
      build(*top(), *state);
      return true;
    }
    default:
      return false;
  }
}

}  // namespace mocaplm
