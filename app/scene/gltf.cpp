#include "app/scene/gltf.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "common/error.h"
#include "common/json.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr int kFloat = 5126;  // glTF's number for the type of a component
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

void append_u32(std::string& bytes, std::size_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

class Plain {
 public:
  Plain(Json& gltf, const std::string& file, std::vector<Remark>& remarks)
      : gltf_(gltf), file_(file), remarks_(remarks) {}

  void make() {
    const std::string version = gltf_.at("asset").at("version");
    if (version.rfind("2.", 0) != 0) fail("is glTF " + version + ", expected 2.0");
    const auto uses = [&](const char* extension) {
      const Json used = gltf_.value("extensionsUsed", Json::array());
      return std::find(used.begin(), used.end(), extension) != used.end();
    };
    if (uses(kMeshopt))
      fail(std::string("is compressed (") + kMeshopt + "); export it without compression");
    check_tree();
    if (uses(kDraco)) drop_meshes();
    name_nodes();
    for (Json& animation : list("animations")) make_plain(animation);
    drop_looks();
    need_scene();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw DataError(in_file(file_), what); }

  Json& list(const char* key) {
    if (!gltf_.contains(key)) gltf_[key] = Json::array();
    if (!gltf_[key].is_array()) fail(std::string("has \"") + key + "\" that is no list");
    return gltf_[key];
  }
  std::size_t index(const Json& number, std::size_t size, const char* what) const {
    if (!number.is_number_unsigned() || number.get<std::size_t>() >= size)
      fail("names " + std::string(what) + " " + number.dump().substr(0, 40) + ", but has " +
           std::to_string(size));
    return number.get<std::size_t>();
  }

  // Every node hangs on one other node or on none, and no chain of parents comes back to itself.
  void check_tree() {
    const Json& nodes = list("nodes");
    constexpr std::size_t kNone = SIZE_MAX;
    std::vector<std::size_t> parents(nodes.size(), kNone);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const Json& child : nodes[i].value("children", Json::array())) {
        const std::size_t c = index(child, nodes.size(), "node");
        if (parents[c] != kNone)
          fail("node " + std::to_string(c) + " hangs on two nodes, " + std::to_string(parents[c]) +
               " and " + std::to_string(i));
        parents[c] = i;
      }
    std::vector<bool> ends_well(nodes.size(), false);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::vector<std::size_t> chain;
      std::size_t at = i;
      for (; at != kNone && !ends_well[at]; at = parents[at]) {
        if (chain.size() > nodes.size()) fail("node " + std::to_string(i) + " hangs in a circle");
        chain.push_back(at);
      }
      for (const std::size_t passed : chain) ends_well[passed] = true;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (parents[i] == kNone) roots_.push_back(i);
  }

  // The names of VRM's bones, which a .vrma gives to its nodes (VRMC_vrm_animation-1.0).
  void name_nodes() {
    Json& nodes = list("nodes");
    std::set<std::string> taken;
    std::vector<bool> named(nodes.size(), false);
    const Json::json_pointer bones("/extensions/VRMC_vrm_animation/humanoid/humanBones");
    if (gltf_.contains(bones))
      for (const auto& [bone, where] : gltf_.at(bones).items()) {
        const std::size_t i = index(where.at("node"), nodes.size(), "node");
        nodes[i]["name"] = bone;
        named[i] = taken.insert(bone).second;
      }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (named[i]) continue;
      const std::string given = nodes[i].value("name", "");
      std::string name = given.empty() ? "node " + std::to_string(i) : given;
      for (int n = 2; !taken.insert(name).second; ++n) name = given + "." + std::to_string(n);
      nodes[i]["name"] = name;
    }
  }

  void make_plain(Json& animation) {
    const Json& samplers = animation.at("samplers");
    Json channels = Json::array();
    std::size_t steps = 0, cubic = 0;
    for (const Json& channel : animation.at("channels")) {
      const Json& target = channel.at("target");
      const std::string path = target.value("path", "");
      if (!target.contains("node") ||
          (path != "translation" && path != "rotation" && path != "scale"))
        continue;
      index(target.at("node"), list("nodes").size(), "node");
      const Json& sampler = samplers.at(index(channel.at("sampler"), samplers.size(), "sampler"));
      check_floats(sampler.at("input"));
      check_floats(sampler.at("output"));
      const std::string kind = sampler.value("interpolation", "LINEAR");
      steps += kind == "STEP";
      cubic += kind == "CUBICSPLINE";
      channels.push_back(channel);
    }
    animation["channels"] = channels;
    const std::string name = animation.value("name", "");
    if (steps + cubic > 0)
      remarks_.push_back({"keys not linear",
                          "animation \"" + name + "\" joins the keys of " + std::to_string(cubic) +
                              " channels by cubic curves and " + std::to_string(steps) +
                              " in steps; here straight lines join them"});
  }
  void check_floats(const Json& accessor) {
    const Json& accessors = list("accessors");
    const Json& found = accessors[index(accessor, accessors.size(), "accessor")];
    if (found.at("componentType") != kFloat)
      fail("stores keys of its animation as whole numbers; export it without quantisation");
  }

  void drop_meshes() {
    for (const char* key : {"meshes", "skins"}) gltf_.erase(key);
    for (Json& node : list("nodes"))
      for (const char* key : {"mesh", "skin"}) node.erase(key);
    remarks_.push_back({"compressed mesh",
                        "its mesh is compressed and was left out, so the rest pose is that of the "
                        "nodes, not of the skin"});
  }

  void drop_looks() {
    for (const char* key : {"materials", "textures", "images", "samplers"}) gltf_.erase(key);
    for (Json& mesh : list("meshes"))
      for (Json& primitive : mesh.at("primitives"))
        for (const char* key : {"material", "targets", "extensions"}) primitive.erase(key);
  }

  void need_scene() {
    if (!list("scenes").empty()) {
      if (!gltf_.contains("scene")) gltf_["scene"] = 0U;
      index(gltf_["scene"], list("scenes").size(), "scene");
      return;
    }
    gltf_["scenes"].push_back(Json{{"nodes", roots_}});
    gltf_["scene"] = 0U;
  }

  Json& gltf_;
  const std::string& file_;
  std::vector<Remark>& remarks_;
  std::vector<std::size_t> roots_;
};

std::string plain_text(const std::string& text, const std::string& file,
                       std::vector<Remark>& remarks) {
  Json gltf = parse_json(text, file);
  try {
    Plain(gltf, file, remarks).make();
  } catch (const Json::exception& error) {
    throw DataError(in_file(file), std::string("is no sound glTF: ") + error.what());
  }
  return gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string plain_gltf(const std::string& bytes, const std::string& file,
                       std::vector<Remark>& remarks) {
  if (bytes.rfind("glTF", 0) != 0) return plain_text(bytes, file, remarks);
  if (bytes.size() < 20 || bytes.compare(16, 4, "JSON") != 0)
    throw DataError(in_file(file), "does not go on as a binary glTF 2.0 file does (JSON)");
  const std::size_t length = u32(bytes, 12), total = u32(bytes, 8);
  if (length > bytes.size() - 20 || total > bytes.size())
    throw DataError(at_byte(file, 8),
                    "announces " + std::to_string(total) + " bytes, " + std::to_string(length) +
                        " of them JSON, and ends after " + std::to_string(bytes.size()));
  std::string text = plain_text(bytes.substr(20, length), file, remarks);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string plain = "glTF";
  append_u32(plain, 2);
  append_u32(plain, 20 + text.size() + (bytes.size() - 20 - length));
  append_u32(plain, text.size());
  plain += "JSON" + text;
  return plain.append(bytes, 20 + length);
}

}  // namespace mocaplm
