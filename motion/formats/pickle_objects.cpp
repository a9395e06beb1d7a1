// Objects of the few classes that hold arrays, and joblib's arrays in the file. Nothing of a class
// is run: an object is its class's name and the values of its state.
#include "motion/formats/pickle_machine.h"

namespace mocaplm {

namespace {

bool is_container(std::string_view name) {
  return name == "builtins.dict" || name == "__builtin__.dict" || name == "builtins.list" ||
         name == "__builtin__.list" || name == "builtins.set" || name == "__builtin__.set" ||
         name == "collections.OrderedDict" || name == "collections.defaultdict" ||
         name == "torch.Size";
}

bool is_dictionary(std::string_view name) {
  return name == "builtins.dict" || name == "__builtin__.dict" ||
         name == "collections.OrderedDict" || name == "collections.defaultdict";
}

bool holds_arrays(std::string_view name) {
  return name == "joblib.numpy_pickle.NumpyArrayWrapper" || name == "chumpy.ch.Ch" ||
         name.substr(0, 13) == "scipy.sparse.";
}

}  // namespace

// A small file may ask for the same long list again and again.
void PickleMachine::copy_items(PickleValue& into, const PickleValue& from) {
  const std::vector<PickleValue*> items = from.items;  // `into` itself, perhaps
  if ((copied_items_ += items.size()) > kMaxPickleValues) fail("copies more than 1000000 items");
  into.items.insert(into.items.end(), items.begin(), items.end());
}

void PickleMachine::set_objects(PickleValue& object, const PickleValue& data) {
  if (data.kind != PickleKind::list)
    fail("an array of Python objects holds " + describe(data) + ", expected a list");
  object.kind = PickleKind::list;
  copy_items(object, data);
  object.built = true;
}

bool PickleMachine::call_class(std::string_view name, const PickleValue& arguments) {
  const auto& items = arguments.items;
  if (name == "copyreg._reconstructor" || name == "copy_reg._reconstructor") {
    if (items.empty()) fail("rebuilds an object of nothing");
    make_object(*items[0]);
    return true;
  }
  if (!is_container(name)) return false;
  if (is_dictionary(name)) {
    // An ordered dictionary of Python 2 is made from a list of pairs.
    PickleValue* dictionary = make(PickleKind::dictionary);
    if (name == "collections.OrderedDict" && !items.empty())
      for (const PickleValue* pair : items[0]->items) {
        if (pair->items.size() != 2) fail("makes a dictionary of something other than pairs");
        copy_items(*dictionary, *pair);
      }
    push(dictionary);
    return true;
  }
  PickleValue* list = make(PickleKind::list);
  if (!items.empty()) copy_items(*list, *items[0]);
  push(list);
  return true;
}

void PickleMachine::make_object(const PickleValue& type) {
  if (type.kind != PickleKind::global) fail("makes an object of " + describe(type));
  if (is_dictionary(type.text)) return push(make(PickleKind::dictionary));
  if (!holds_arrays(type.text))
    fail("makes an object of " + std::string(type.text) + ", which is not done here");
  PickleValue* object = make(PickleKind::object);
  object->text = type.text;
  push(object);
}

void PickleMachine::build_object(PickleValue& object, const PickleValue& state) {
  if (object.built) fail("sets the state of " + describe(object) + " twice");
  if (state.kind != PickleKind::dictionary)
    fail("sets the state of " + describe(object) + " from " + describe(state));
  copy_items(object, state);
  object.built = true;
  if (object.text == "joblib.numpy_pickle.NumpyArrayWrapper") read_joblib_array(object);
}

// The wrapper's state has shape, order and dtype; the array's bytes follow in the file, since
// joblib 1.2 aligned by a byte that says how many bytes to leave out.
void PickleMachine::read_joblib_array(PickleValue& wrapper) {
  const PickleValue *shape = find_value(wrapper, "shape"), *type = find_value(wrapper, "dtype"),
                    *order = find_value(wrapper, "order"),
                    *alignment = find_value(wrapper, "numpy_array_alignment_bytes");
  if (shape == nullptr || type == nullptr || order == nullptr || type->kind != PickleKind::type)
    fail("a joblib array lacks its shape, order or dtype");
  if (type->array.type.kind == 'O') {  // a pickle of its own
    if (depth_ >= kMaxPickleDepth) fail("pickles nested more than 4 deep");
    PickleMachine inner(bytes_.substr(at_), file_, pickle_, depth_ + 1);
    const PickleValue* value = inner.run();
    at_ += inner.read();
    if (value->kind != PickleKind::list) fail("an array of Python objects is " + describe(*value));
    set_objects(wrapper, *value);
    return;
  }
  set_shape(wrapper.array, *shape);
  wrapper.array.type = type->array.type;
  wrapper.array.column_major = order->text == "F";
  if (alignment != nullptr && alignment->kind == PickleKind::integer) take(little_endian(1));
  std::size_t bytes = wrapper.array.type.item_bytes;
  for (const std::size_t n : wrapper.array.shape)
    if (__builtin_mul_overflow(bytes, n, &bytes)) fail("an array of more than 2^64 bytes");
  wrapper.array.data = take(bytes);
  wrapper.kind = PickleKind::array;
  wrapper.items.clear();
}

}  // namespace mocaplm
