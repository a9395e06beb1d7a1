#include <zlib.h>

#include <cstring>
#include <deque>
#include <map>
#include <mutex>

#include "common/error.h"
#include "common/text.h"
#include "motion/formats/array_dict_node.h"

namespace mocaplm {

namespace {

constexpr std::size_t kMaxInflated = std::size_t{512} << 20;
constexpr std::size_t kMaxKeys = 100000;
constexpr std::size_t kMaxStacked = std::size_t{64} << 20;  // bytes of arrays put together of lists

// One pickle with its bytes, shared by all dictionaries in it.
struct PickleFile {
  PickleFile(std::string b, const std::string& file, LoadStorage load)
      : bytes(std::move(b)), pickle(bytes, file, std::move(load)) {}
  std::string bytes;
  Pickle pickle;
  std::mutex mutex;
  std::deque<std::string> made;  // arrays of numbers and lists
  std::size_t made_bytes = 0;
};

bool is_number(const PickleValue& value) {
  return value.kind == PickleKind::integer || value.kind == PickleKind::number ||
         value.kind == PickleKind::boolean;
}

std::string key_text(const PickleValue& key) {
  if (key.kind == PickleKind::text || key.kind == PickleKind::bytes) return std::string(key.text);
  if (is_number(key)) return format_number(key.number);
  if (key.kind == PickleKind::array && key.built && key.array.shape.empty() &&
      key.array.type.is_number())
    return format_number(key.array.at(0, 0));
  return "";
}

// np.save makes an array of one object of a dictionary.
const PickleValue& unwrapped(const PickleValue& value) {
  const bool array = value.kind == PickleKind::list && value.built;
  return array && value.items.size() == 1 && value.items[0]->kind == PickleKind::dictionary
             ? *value.items[0]
             : value;
}

class PickleNode : public ArrayDictNode {
 public:
  PickleNode(std::shared_ptr<PickleFile> pickle, const PickleValue& value, const std::string& name)
      : pickle_(std::move(pickle)), value_(value) {
    file = name;
    for (std::size_t i = 0; !is_list() && i + 1 < value_.items.size(); i += 2)
      index_[key_text(*value_.items[i])] = value_.items[i + 1];
  }
  std::vector<std::string> keys() const override {
    std::vector<std::string> keys;
    const std::size_t step = is_list() ? 1 : 2;
    for (std::size_t i = 0; i < value_.items.size() && keys.size() < kMaxKeys; i += step)
      keys.push_back(is_list() ? std::to_string(i) : key_text(*value_.items[i]));
    return keys;
  }
  bool has(const std::string& key) const override {
    const PickleValue* value = find(key);
    return value != nullptr && value->kind != PickleKind::none;
  }
  NumpyArray array(const std::string& key) const override {
    const PickleValue& value = known(key);
    if (value.kind == PickleKind::array && value.built) return value.array;
    if (is_number(value)) return store(&value.number, {});
    if (value.kind == PickleKind::list || value.kind == PickleKind::tuple) {
      if (const auto stacked = stack(value)) return *stacked;
    }
    if (const PickleValue* x = find_value(value, "x"); x != nullptr && x->built) return x->array;
    throw DataError(place(key),
                    key + " is " + describe(value) + ", expected a numpy array of numbers");
  }
  std::optional<ArrayDict> dict(const std::string& key) const override {
    const PickleValue* value = find(key);
    if (value == nullptr) return std::nullopt;
    value = &unwrapped(*value);
    if (value->kind != PickleKind::dictionary && value->kind != PickleKind::list &&
        value->kind != PickleKind::tuple && value->kind != PickleKind::object)
      return std::nullopt;
    return ArrayDict(std::make_shared<PickleNode>(pickle_, *value, file));
  }
  std::optional<std::string> text(const std::string& key) const override {
    const PickleValue* value = find(key);
    if (value == nullptr) return std::nullopt;
    if (value->kind == PickleKind::text || value->kind == PickleKind::bytes)
      return std::string(value->text);
    if (value->kind == PickleKind::list && value->items.size() == 1 &&
        value->items[0]->kind == PickleKind::text)
      return std::string(value->items[0]->text);
    return std::nullopt;
  }
  Place place(const std::string& key) const override {
    const PickleValue* value = find(key);
    return value != nullptr ? at_byte(file, value->byte) : in_file(file);
  }

 private:
  bool is_list() const {
    return value_.kind == PickleKind::list || value_.kind == PickleKind::tuple;
  }
  const PickleValue* find(const std::string& key) const {
    if (is_list()) {
      const std::size_t i =
          key.size() < 9 ? std::strtoul(key.c_str(), nullptr, 10) : value_.items.size();
      return i < value_.items.size() && key == std::to_string(i) ? value_.items[i] : nullptr;
    }
    const auto found = index_.find(key);
    return found != index_.end() ? found->second : nullptr;
  }
  const PickleValue& known(const std::string& key) const {
    const PickleValue* value = find(key);
    if (value == nullptr) throw DataError(in_file(file), "has no " + key);
    return *value;
  }
  NumpyArray store(const double* values, std::vector<std::size_t> shape) const {
    std::size_t count = 1;
    for (const std::size_t n : shape) count *= n;
    const std::uint16_t one = 1;
    NumpyArray array;
    array.type.big_endian = *reinterpret_cast<const unsigned char*>(&one) == 0;
    array.shape = std::move(shape);
    const std::lock_guard<std::mutex> lock(pickle_->mutex);
    pickle_->made.emplace_back(reinterpret_cast<const char*>(values), 8 * count);
    array.data = pickle_->made.back();
    return array;
  }
  // A list of numbers, or of arrays of one shape and type.
  std::optional<NumpyArray> stack(const PickleValue& list) const {
    if (list.items.empty()) return std::nullopt;
    const PickleValue& first = *list.items[0];
    if (is_number(first)) {
      std::vector<double> values;
      for (const PickleValue* item : list.items) {
        if (!is_number(*item)) return std::nullopt;
        values.push_back(item->number);
      }
      return store(values.data(), {values.size()});
    }
    std::string bytes;
    for (const PickleValue* item : list.items) {
      if (item->kind != PickleKind::array || !item->built ||
          item->array.shape != first.array.shape ||
          item->array.type.kind != first.array.type.kind ||
          item->array.type.item_bytes != first.array.type.item_bytes ||
          item->array.type.big_endian != first.array.type.big_endian ||
          (item->array.column_major && item->array.shape.size() > 1))
        return std::nullopt;
      bytes.append(item->array.data);
      if (bytes.size() > kMaxStacked) return std::nullopt;
    }
    NumpyArray array = first.array;
    array.column_major = false;
    array.shape.insert(array.shape.begin(), list.items.size());
    const std::lock_guard<std::mutex> lock(pickle_->mutex);
    if ((pickle_->made_bytes += bytes.size()) > kMaxInflated) return std::nullopt;
    pickle_->made.push_back(std::move(bytes));
    array.data = pickle_->made.back();
    return array;
  }

  std::shared_ptr<PickleFile> pickle_;
  const PickleValue& value_;
  std::map<std::string, const PickleValue*> index_;  // as in Python, the last one of a key counts
};

}  // namespace

ArrayDict pickled_dict(std::string bytes, const std::string& file, LoadStorage load) {
  auto pickle = std::make_shared<PickleFile>(std::move(bytes), file, std::move(load));
  const PickleValue* root = &pickle->pickle.root();
  root = &unwrapped(*root);
  if (root->kind != PickleKind::dictionary && root->kind != PickleKind::list &&
      root->kind != PickleKind::tuple)
    throw DataError(in_file(file),
                    "it is " + describe(*root) + ", expected a dictionary of numpy arrays");
  return ArrayDict(std::make_shared<PickleNode>(pickle, *root, file));
}

std::string_view pickle_of_npy(std::string_view bytes) {
  if (bytes.size() < 12) return {};
  const std::size_t start = bytes[6] == 1 ? 10 : 12;
  std::size_t length = 0;
  for (std::size_t i = start; i > 8; --i)
    length = length << 8 | static_cast<unsigned char>(bytes[i - 1]);
  if (length > bytes.size() - start) return {};
  const std::string_view header = bytes.substr(start, length);
  if (header.find("'|O'") == std::string_view::npos && header.find("'O'") == std::string_view::npos)
    return {};
  return bytes.substr(start + length);
}

std::string inflate(std::string_view bytes, const std::string& file) {
  z_stream stream;
  std::memset(&stream, 0, sizeof stream);
  if (inflateInit2(&stream, 15 + 32) != Z_OK) throw DataError(in_file(file), "cannot be unpacked");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  std::vector<char> part(1 << 20);
  for (int status = Z_OK; status != Z_STREAM_END;) {
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    status = ::inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END)
      throw DataError(at_byte(file, stream.total_in),
                      "its compressed data are cut off or damaged (zlib)");
    out.append(part.data(), part.size() - stream.avail_out);
    // As for zip archives: beyond a small size real arrays never reach 100 to 1.
    if (out.size() > kMaxInflated || (out.size() > (16u << 20) && out.size() / 100 > bytes.size()))
      throw DataError(in_file(file), "would grow from " + std::to_string(bytes.size()) +
                                         " to over " + std::to_string(out.size()) +
                                         " bytes: refused as a bomb");
  }
  return out;
}

}  // namespace mocaplm
