// How numpy rebuilds arrays from a pickle: numpy/_core/src/multiarray/{methods,descriptor}.c,
// __reduce__.
#include <cstring>

#include "common/text.h"
#include "motion/formats/pickle_machine.h"

namespace mocaplm {

namespace {

// Module and name as one text, as messages show it.
constexpr const char* kGlobals[] = {"numpy.core.multiarray._reconstruct",
                                    "numpy._core.multiarray._reconstruct",
                                    "numpy.core.multiarray.scalar",
                                    "numpy._core.multiarray.scalar",
                                    "numpy.core.numeric._frombuffer",
                                    "numpy._core.numeric._frombuffer",
                                    "numpy.ndarray",
                                    "numpy.dtype",
                                    "_codecs.encode",
                                    "builtins.dict",
                                    "builtins.list",
                                    "builtins.int",
                                    "builtins.float",
                                    "builtins.set",
                                    "builtins.object",
                                    "__builtin__.set",
                                    "__builtin__.object",
                                    "__builtin__.dict",
                                    "__builtin__.list",
                                    "collections.OrderedDict",
                                    "collections.defaultdict",
                                    "copy_reg._reconstructor",
                                    "copyreg._reconstructor",
                                    "joblib.numpy_pickle.NumpyArrayWrapper",
                                    "chumpy.ch.Ch",
                                    "scipy.sparse.csc.csc_matrix",
                                    "scipy.sparse._csc.csc_matrix",
                                    "scipy.sparse.csr.csr_matrix",
                                    "scipy.sparse._csr.csr_matrix",
                                    "scipy.sparse._csc.csc_array",
                                    "scipy.sparse._csr.csr_array",
                                    "torch._utils._rebuild_tensor_v2",
                                    "torch._utils._rebuild_parameter",
                                    "torch.storage._load_from_bytes",
                                    "torch.FloatStorage",
                                    "torch.DoubleStorage",
                                    "torch.HalfStorage",
                                    "torch.LongStorage",
                                    "torch.IntStorage",
                                    "torch.ShortStorage",
                                    "torch.CharStorage",
                                    "torch.ByteStorage",
                                    "torch.BoolStorage",
                                    "torch.Size"};

bool is_text(const PickleValue& value) {
  return value.kind == PickleKind::text || value.kind == PickleKind::bytes;
}

std::string printable(std::string_view text) {
  std::string out(text.substr(0, 100));
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

}  // namespace

void PickleMachine::push_global(std::string_view module, std::string_view name) {
  const std::string full =
      std::string(module.substr(0, 200)) + "." + std::string(name.substr(0, 200));
  for (const char* known : kGlobals) {
    if (full != known) continue;
    push_text(PickleKind::global, known);
    return;
  }
  fail("refuses the global " + printable(full) +
       ": only arrays of numbers are read, and nothing in a pickle is executed");
}

void PickleMachine::call(const PickleValue& function, const PickleValue& arguments) {
  if (function.kind != PickleKind::global) fail("calls " + describe(function));
  if (arguments.kind != PickleKind::tuple) fail("calls a function with " + describe(arguments));
  const auto& items = arguments.items;
  const std::string_view name = function.text;
  if (name == "numpy.dtype" && !items.empty()) {
    call_dtype(arguments);
  } else if (name == "_codecs.encode") {
    call_encode(arguments);
  } else if (ends_with(name, "._reconstruct") && items.size() == 3) {
    // (ndarray, (0,), b"b"): an empty array, which the state that follows fills.
    if (items[0]->kind != PickleKind::global || items[0]->text != "numpy.ndarray")
      fail("rebuilds " + describe(*items[0]) + ", expected numpy.ndarray");
    push(make(PickleKind::array));
  } else if (ends_with(name, ".scalar") && items.size() == 2) {
    call_array(*items[1], *items[0], nullptr, nullptr);
  } else if (ends_with(name, "._frombuffer") &&
             (items.size() == 4 || (items.size() == 5 && items[4]->kind == PickleKind::none))) {
    // The fifth, an order of axes, is for arrays that lie in memory in neither C nor Fortran order.
    call_array(*items[0], *items[1], items[2], items[3]);
  } else if (!call_class(name, arguments) && !call_torch(name, arguments)) {
    fail("calls " + std::string(name) + " with " + std::to_string(items.size()) +
         " arguments, which numpy does not do");
  }
}

void PickleMachine::call_dtype(const PickleValue& arguments) {
  const PickleValue& text = *arguments.items[0];
  if (!is_text(text)) fail("makes a dtype of " + describe(text));
  PickleValue* type = make(PickleKind::type);
  if (text.text == "O" || text.text == "O8")
    type->array.type.kind = 'O';
  else
    type->array.type = parse_numpy_type(printable(text.text), here());
  push(type);
}

// Latin-1: every character below 256 is one byte. The decoded bytes of a whole file can be no more
// than the file, so a text that is decoded again and again stops here.
void PickleMachine::call_encode(const PickleValue& arguments) {
  const auto& items = arguments.items;
  if (items.size() != 2 || items[0]->kind != PickleKind::text ||
      items[1]->kind != PickleKind::text ||
      (items[1]->text != "latin1" && items[1]->text != "latin-1"))
    fail("calls _codecs.encode with something other than a text and \"latin1\"");
  const std::string_view text = items[0]->text;
  decoded_bytes_ += text.size();
  if (decoded_bytes_ > bytes_.size()) fail("decodes more text than the file holds");
  std::string& out = pickle_.decoded_.emplace_back();
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x80) {
      out += text[i];
      continue;
    }
    const unsigned next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    if ((c != 0xc2 && c != 0xc3) || (next & 0xc0) != 0x80)
      throw DataError(at_byte(file_, items[0]->byte), "holds a character beyond Latin-1");
    out += static_cast<char>((c & 3) << 6 | (next & 0x3f));
    ++i;
  }
  push_text(PickleKind::bytes, out);
}

void PickleMachine::call_array(const PickleValue& data, const PickleValue& type,
                               const PickleValue* shape, const PickleValue* order) {
  PickleValue* object = make(PickleKind::array);
  if (shape != nullptr) set_shape(object->array, *shape);
  if (order != nullptr) {
    if (!is_text(*order) || (order->text != "C" && order->text != "F"))
      fail("an array in the order of " + describe(*order) + ", expected \"C\" or \"F\"");
    object->array.column_major = order->text == "F";
  }
  set_data(*object, type, data);
  push(object);
}

void PickleMachine::build(PickleValue& object, const PickleValue& state) {
  if (object.kind == PickleKind::object) return build_object(object, state);
  if (object.kind != PickleKind::type && object.kind != PickleKind::array)
    fail("sets the state of " + describe(object));
  if (object.built) fail("sets the state of " + describe(object) + " twice");
  if (state.kind != PickleKind::tuple) fail("sets a state from " + describe(state));
  if (object.kind == PickleKind::type)
    build_type(object, state);
  else
    build_array(object, state);
  object.built = true;
}

// (version, byte order, sub-array, names, fields, item size, alignment, flags[, metadata])
void PickleMachine::build_type(PickleValue& object, const PickleValue& state) {
  const auto& items = state.items;
  if (items.size() < 8 || !is_text(*items[1]) || items[1]->text.size() != 1 ||
      std::strchr("<>|=", items[1]->text[0]) == nullptr || items[1]->text[0] == 0)
    fail("a dtype's state is not (version, byte order, ...)");
  if (object.array.type.kind == 'O') return;
  for (std::size_t i : {2, 3, 4})
    if (items[i]->kind != PickleKind::none) fail("a dtype of structures, expected plain numbers");
  object.array.type.big_endian = items[1]->text == ">";
  // Texts say their size here when the name did not.
  const double size = items[5]->kind == PickleKind::integer ? items[5]->number : -1;
  if (size > 0 && size < 1 << 22 && !object.array.type.is_number())
    object.array.type.item_bytes = static_cast<std::size_t>(size);
}

// ([version,] shape, dtype, Fortran order, bytes)
void PickleMachine::build_array(PickleValue& object, const PickleValue& state) {
  const std::size_t first = state.items.size() == 5 ? 1 : 0;
  if (state.items.size() != 4 + first)
    fail("an array's state is not (version, shape, dtype, order, data)");
  const PickleValue* const* items = state.items.data() + first;
  if (items[2]->kind != PickleKind::boolean && items[2]->kind != PickleKind::integer)
    fail("an array's order is " + describe(*items[2]) + ", expected True or False");
  set_shape(object.array, *items[0]);
  object.array.column_major = items[2]->number != 0;
  set_data(object, *items[1], *items[3]);
}

void PickleMachine::set_shape(NumpyArray& array, const PickleValue& shape) {
  if (shape.kind != PickleKind::tuple || shape.items.size() > 32)
    fail("an array's shape is " + describe(shape) + ", expected a tuple of up to 32 numbers");
  array.shape.clear();
  for (const PickleValue* n : shape.items) {
    if (n->kind != PickleKind::integer || n->number < 0 || n->number > 1e15)
      fail("an array's shape holds " + describe(*n) + ", expected whole numbers from 0");
    array.shape.push_back(static_cast<std::size_t>(n->number));
  }
}

void PickleMachine::set_data(PickleValue& object, const PickleValue& type,
                             const PickleValue& data) {
  if (type.kind != PickleKind::type) fail("an array's dtype is " + describe(type));
  if (type.array.type.kind == 'O') return set_objects(object, data);
  if (data.kind != PickleKind::bytes)
    fail("an array's data are " + describe(data) + ", expected bytes of numbers");
  object.array.type = type.array.type;
  object.array.data = data.text;
  object.built = true;
  check_array_size(object.array, at_byte(file_, data.byte));
}

}  // namespace mocaplm
