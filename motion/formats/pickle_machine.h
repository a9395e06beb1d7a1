// The stack machine behind Pickle.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "motion/formats/pickle.h"

namespace mocaplm {

constexpr int kMaxPickleDepth = 4;
constexpr std::size_t kMaxPickleValues = 1000000, kMaxPickleMemo = 1000000, kMaxPickleStack = 10000;

class PickleMachine {
 public:
  // `depth`: how many pickles this one lies in.
  PickleMachine(std::string_view bytes, const std::string& file, Pickle& pickle, int depth = 0)
      : bytes_(bytes), file_(file), pickle_(pickle), depth_(depth) {}
  // Runs to STOP; returns the object left on the stack.
  PickleValue* run();
  // Bytes read so far.
  std::size_t read() const { return at_; }

 private:
  // Returns false when the opcode is not one of the group's.
  bool run_atom(unsigned char opcode);       // numbers, text, bytes
  bool run_container(unsigned char opcode);  // tuples, lists, dictionaries
  bool run_memo(unsigned char opcode);
  bool run_object(unsigned char opcode);  // globals, calls, state

  // Input.
  [[noreturn]] void fail(const std::string& message) const;
  std::uint64_t little_endian(std::size_t count);
  std::string_view take(std::uint64_t count);
  std::string_view counted(std::size_t count_bytes);
  std::string_view line();
  double big_endian_double();

  // Stack and memo.
  PickleValue* make(PickleKind kind);
  void push(PickleValue* value);
  PickleValue* pop();
  PickleValue* top() const;
  std::vector<PickleValue*> pop_to_mark();
  void remember(std::uint64_t index);
  void recall(std::uint64_t index);
  void push_number(PickleKind kind, double number);
  void push_text(PickleKind kind, std::string_view text);

  // numpy.
  void push_global(std::string_view module, std::string_view name);
  void call(const PickleValue& function, const PickleValue& arguments);
  void call_dtype(const PickleValue& arguments);
  void call_array(const PickleValue& data, const PickleValue& type, const PickleValue* shape,
                  const PickleValue* order);
  void call_encode(const PickleValue& arguments);
  void build(PickleValue& object, const PickleValue& state);
  void build_type(PickleValue& object, const PickleValue& state);
  void build_array(PickleValue& object, const PickleValue& state);
  void set_shape(NumpyArray& array, const PickleValue& shape);
  void set_data(PickleValue& object, const PickleValue& type, const PickleValue& data);
  void copy_items(PickleValue& into, const PickleValue& from);
  // An array of objects becomes a list.
  void set_objects(PickleValue& object, const PickleValue& data);

  // Classes that hold arrays (pickle_objects.cpp).
  bool call_class(std::string_view name, const PickleValue& arguments);
  void make_object(const PickleValue& type);
  void build_object(PickleValue& object, const PickleValue& state);
  void read_joblib_array(PickleValue& wrapper);

  // PyTorch (pickle_torch.cpp).
  bool call_torch(std::string_view name, const PickleValue& arguments);
  void load_storage(const PickleValue& id);
  void load_storage_bytes(const PickleValue& bytes);
  void rebuild_tensor(const PickleValue& arguments);
  NumpyType storage_type(const PickleValue& type) const;

  Place here() const { return at_byte(file_, opcode_at_); }

  std::string_view bytes_;
  const std::string& file_;
  Pickle& pickle_;
  int depth_ = 0;
  std::size_t at_ = 0, opcode_at_ = 0, decoded_bytes_ = 0, gathered_ = 0, copied_items_ = 0,
              nested_bytes_ = 0;
  PickleValue* legacy_storage_ = nullptr;  // the one whose bytes follow the pickle
  std::vector<PickleValue*> stack_;
  std::vector<std::size_t> marks_;  // stack heights
  std::map<std::uint64_t, PickleValue*> memo_;
};

}  // namespace mocaplm
