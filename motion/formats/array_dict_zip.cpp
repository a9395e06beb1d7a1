#include <map>
#include <mutex>

#include "common/error.h"
#include "motion/formats/array_dict_node.h"
#include "motion/formats/npy.h"
#include "motion/formats/zip_file.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// A .npz: every entry is read when it is asked for, once.
class ZipNode : public ArrayDictNode {
 public:
  ZipNode(const fs::path& path, std::shared_ptr<const ZipReader> zip) : zip_(std::move(zip)) {
    file = path.string();
  }
  std::vector<std::string> keys() const override {
    std::vector<std::string> keys = zip_->names();
    for (std::string& key : keys)
      if (key.size() > 4 && key.compare(key.size() - 4, 4, ".npy") == 0) key.resize(key.size() - 4);
    return keys;
  }
  bool has(const std::string& key) const override { return zip_->has(key + ".npy"); }
  NumpyArray array(const std::string& key) const override {
    const std::string& bytes = entry(key);
    const std::string_view pickle = pickle_of_npy(bytes);
    if (pickle.empty()) return parse_npy(bytes, place(key).file);
    // An array of objects may be a list of arrays, which the pickle's reader puts together.
    throw DataError(place(key), key + " holds Python objects, expected numbers");
  }
  std::optional<ArrayDict> dict(const std::string& key) const override {
    if (!has(key)) return std::nullopt;
    const std::string_view pickle = pickle_of_npy(entry(key));
    if (pickle.empty()) return std::nullopt;
    return pickled_dict(std::string(pickle), place(key).file);
  }
  std::optional<std::string> text(const std::string& key) const override {
    if (!has(key)) return std::nullopt;
    const std::string& bytes = entry(key);
    if (const std::string_view pickle = pickle_of_npy(bytes); !pickle.empty())
      return pickled_dict(std::string(pickle), place(key).file).text("0");
    const NumpyArray array = parse_npy(bytes, place(key).file);
    if (array.type.is_number() || array.data.size() != array.type.item_bytes) return std::nullopt;
    return single_text(array, place(key));
  }
  Place place(const std::string& key) const override { return in_file(file + ": " + key + ".npy"); }

 private:
  const std::string& entry(const std::string& key) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    auto found = entries_.find(key);
    if (found == entries_.end()) found = entries_.emplace(key, zip_->read(key + ".npy")).first;
    return found->second;
  }

  std::shared_ptr<const ZipReader> zip_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::string> entries_;
};

// torch.save: NAME/data.pkl and the storages NAME/data/KEY.
ArrayDict torch_archive(std::shared_ptr<const ZipReader> zip, const std::string& pickle,
                        const std::string& file) {
  const std::string folder = pickle.substr(0, pickle.size() - 8);
  const auto storages = std::make_shared<std::map<std::string, std::string>>();
  const std::string bytes = zip->read(pickle);
  return pickled_dict(bytes, file,
                      [zip, storages, folder](const std::string& key) -> std::string_view {
                        auto found = storages->find(key);
                        if (found == storages->end())
                          found = storages->emplace(key, zip->read(folder + "data/" + key)).first;
                        return found->second;
                      });
}

}  // namespace

ArrayDict archived_dict(const fs::path& path) {
  const auto zip = std::make_shared<const ZipReader>(path);
  for (const std::string& name : zip->names())
    if (name.size() >= 9 && name.compare(name.size() - 9, 9, "/data.pkl") == 0)
      return torch_archive(zip, name, path.string());
  return ArrayDict(std::make_shared<ZipNode>(path, zip));
}

}  // namespace mocaplm
