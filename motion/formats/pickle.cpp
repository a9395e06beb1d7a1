#include "motion/formats/pickle.h"

#include "motion/formats/pickle_machine.h"

namespace mocaplm {

std::string describe(const PickleValue& value) {
  switch (value.kind) {
    case PickleKind::none:
      return "None";
    case PickleKind::boolean:
      return "True or False";
    case PickleKind::integer:
    case PickleKind::number:
      return "a number";
    case PickleKind::text:
      return "a text";
    case PickleKind::bytes:
      return "bytes";
    case PickleKind::tuple:
      return "a tuple";
    case PickleKind::list:
      return "a list";
    case PickleKind::dictionary:
      return "a dictionary";
    case PickleKind::global:
      return "the function " + std::string(value.text);
    case PickleKind::type:
      return "a dtype";
    case PickleKind::array:
      return "an array " + shape_text(value.array);
    case PickleKind::object:
      return "an object of " + std::string(value.text);
    case PickleKind::storage:
      return "a PyTorch storage";
  }
  return "";
}

Pickle::Pickle(std::string_view bytes, const std::string& file, LoadStorage load)
    : load_(std::move(load)) {
  root_ = PickleMachine(bytes, file, *this).run();
}

const PickleValue* find_value(const PickleValue& dictionary, std::string_view key) {
  if (dictionary.kind != PickleKind::dictionary && dictionary.kind != PickleKind::object)
    return nullptr;
  const PickleValue* found = nullptr;  // as in Python, the last one of a key counts
  for (std::size_t i = 0; i + 1 < dictionary.items.size(); i += 2) {
    const PickleValue& name = *dictionary.items[i];
    if ((name.kind == PickleKind::text || name.kind == PickleKind::bytes) && name.text == key)
      found = dictionary.items[i + 1];
  }
  return found;
}

const PickleValue* Pickle::find(const std::string& key) const {
  return find_value(*root_, key);
}

std::vector<std::string> Pickle::keys() const {
  std::vector<std::string> keys;
  if (root_->kind != PickleKind::dictionary) return keys;
  for (std::size_t i = 0; i + 1 < root_->items.size(); i += 2)
    if (root_->items[i]->kind == PickleKind::text)
      keys.emplace_back(root_->items[i]->text.substr(0, 40));
  return keys;
}

}  // namespace mocaplm
