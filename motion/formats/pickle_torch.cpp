// PyTorch's tensors in pickles: torch/_utils.py and torch/serialization.py. A tensor is a view into
// a storage. In a .pt archive the storage is an entry that a persistent id names; in any other
// pickle it is bytes that torch.save wrote in its older form: pickles of a magic number, a version,
// a note of the system, the storage's id and the list of ids, then the number of elements (8 bytes)
// and the elements.
#include "motion/formats/pickle_machine.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxGathered = 4 << 20;  // elements

}  // namespace

NumpyType PickleMachine::storage_type(const PickleValue& type) const {
  struct Known {
    const char *name, *numpy;
  };
  static constexpr Known known[] = {
      {"torch.FloatStorage", "<f4"}, {"torch.DoubleStorage", "<f8"}, {"torch.HalfStorage", "<f2"},
      {"torch.LongStorage", "<i8"},  {"torch.IntStorage", "<i4"},    {"torch.ShortStorage", "<i2"},
      {"torch.CharStorage", "<i1"},  {"torch.ByteStorage", "<u1"},   {"torch.BoolStorage", "b1"}};
  for (const Known& one : known)
    if (type.kind == PickleKind::global && type.text == one.name)
      return parse_numpy_type(one.numpy, here());
  fail("a storage of " + describe(type) + ", expected one of PyTorch's");
}

bool PickleMachine::call_torch(std::string_view name, const PickleValue& arguments) {
  const auto& items = arguments.items;
  if (name == "torch._utils._rebuild_tensor_v2") {
    rebuild_tensor(arguments);
  } else if (name == "torch._utils._rebuild_parameter" && !items.empty()) {
    push(items[0]);
  } else if (name == "torch.storage._load_from_bytes" && items.size() == 1) {
    load_storage_bytes(*items[0]);
  } else {
    return false;
  }
  return true;
}

// ('storage', class, key, device, elements[, view])
void PickleMachine::load_storage(const PickleValue& id) {
  const auto& items = id.items;
  if (id.kind != PickleKind::tuple || items.size() < 5 || items[0]->text != "storage" ||
      items[4]->kind != PickleKind::integer || items[4]->number < 0 || items[4]->number > 1e12)
    fail("a persistent id that is no PyTorch storage");
  PickleValue* storage = make(PickleKind::storage);
  storage->array.type = storage_type(*items[1]);
  storage->array.shape = {static_cast<std::size_t>(items[4]->number)};
  if (depth_ > 0) {
    legacy_storage_ = storage;
  } else {
    storage->array.data = pickle_.load_(std::string(items[2]->text));
    check_array_size(storage->array, here());
  }
  push(storage);
}

void PickleMachine::load_storage_bytes(const PickleValue& bytes) {
  if (bytes.kind != PickleKind::bytes) fail("a storage in " + describe(bytes));
  if (depth_ >= kMaxPickleDepth) fail("pickles nested more than 4 deep");
  if ((nested_bytes_ += bytes.text.size()) > bytes_.size())
    fail("reads more storages than the file holds");
  std::string_view rest = bytes.text;
  PickleValue* storage = nullptr;
  for (int part = 0; part < 5; ++part) {
    PickleMachine inner(rest, file_, pickle_, depth_ + 1);
    inner.run();
    if (inner.legacy_storage_ != nullptr) storage = inner.legacy_storage_;
    rest.remove_prefix(inner.read());
  }
  if (storage == nullptr || rest.size() < 8) fail("a PyTorch storage without elements");
  rest.remove_prefix(8);
  const std::size_t wanted = storage->array.shape[0] * storage->array.type.item_bytes;
  if (rest.size() < wanted) fail("a PyTorch storage that ends early");
  storage->array.data = rest.substr(0, wanted);
  push(storage);
}

// (storage, offset, shape, stride, requires_grad, hooks[, metadata])
void PickleMachine::rebuild_tensor(const PickleValue& arguments) {
  const auto& items = arguments.items;
  if (items.size() < 4 || items[0]->kind != PickleKind::storage ||
      items[1]->kind != PickleKind::integer || items[3]->kind != PickleKind::tuple)
    fail("a PyTorch tensor without storage, offset, shape and stride");
  const NumpyArray& storage = items[0]->array;
  if (storage.data.size() != storage.shape[0] * storage.type.item_bytes)
    fail("a PyTorch tensor before its storage is there");
  PickleValue* tensor = make(PickleKind::array);
  set_shape(tensor->array, *items[2]);
  tensor->array.type = storage.type;
  const auto& shape = tensor->array.shape;
  const auto& stride = items[3]->items;
  if (stride.size() != shape.size()) fail("a PyTorch tensor's stride does not fit");
  std::size_t count = 1;
  bool plain = true;
  double last = items[1]->number;  // element
  if (last < 0) fail("a PyTorch tensor begins before its storage");
  for (std::size_t d = shape.size(); d-- > 0;) {
    const std::size_t n = shape[d];
    if (stride[d]->kind != PickleKind::integer || stride[d]->number < 0)
      fail("a PyTorch tensor's stride is " + describe(*stride[d]));
    plain = plain && (n <= 1 || stride[d]->number == static_cast<double>(count));
    if (n > 1) last += static_cast<double>(n - 1) * stride[d]->number;
    if (__builtin_mul_overflow(count, n, &count)) fail("a tensor of more than 2^64 elements");
  }
  if (count > 0 && last >= static_cast<double>(storage.shape[0]))
    fail("a PyTorch tensor reaches beyond its storage");
  const std::size_t bytes = storage.type.item_bytes;
  const auto first = static_cast<std::size_t>(items[1]->number) * bytes;
  if (count == 0) {
    tensor->array.data = {};
  } else if (plain) {
    tensor->array.data = storage.data.substr(first, count * bytes);
  } else {
    // A view that repeats, leaves out or turns: its elements one after another.
    if (count > kMaxGathered || (gathered_ += count) > kMaxGathered)
      fail("PyTorch views of more than 4 million elements; save them with .contiguous()");
    std::string& out = pickle_.decoded_.emplace_back();
    out.reserve(count * bytes);
    std::vector<std::size_t> at(shape.size(), 0);
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t element = 0;
      for (std::size_t d = 0; d < at.size(); ++d)
        element += at[d] * static_cast<std::size_t>(stride[d]->number);
      out.append(storage.data.substr(first + element * bytes, bytes));
      for (std::size_t d = at.size(); d-- > 0 && ++at[d] == shape[d];) at[d] = 0;
    }
    tensor->array.data = out;
  }
  tensor->built = true;
  push(tensor);
}

}  // namespace mocaplm
