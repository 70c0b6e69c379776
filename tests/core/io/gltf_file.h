#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/io/numbers.h"

namespace ccst::testing::gltf {

using Json = nlohmann::json;

inline constexpr int kByte = 5120;
inline constexpr int kUbyte = 5121;
inline constexpr int kUshort = 5123;
inline constexpr int kUint = 5125;
inline constexpr int kFloat = 5126;

/// A glTF file put together piece by piece: one scene, whose nodes are added last.
class Gltf {
 public:
  Gltf() { json_["asset"] = {{"version", "2.0"}}; }

  int View(const std::string& bytes, int stride = 0) {
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes.size()}});
    if (stride > 0) json_["bufferViews"].back()["byteStride"] = stride;
    data_ += bytes;
    data_.resize((data_.size() + 3) / 4 * 4);
    return static_cast<int>(json_["bufferViews"].size()) - 1;
  }

  template <typename T>
  int Accessor(const std::vector<T>& values, int type, const std::string& shape, int components,
               bool normalized = false) {
    std::string bytes;
    for (const T value : values) io::AppendLittleEndian(bytes, value);
    json_["accessors"].push_back({{"bufferView", View(bytes)},
                                  {"componentType", type},
                                  {"count", values.size() / static_cast<std::size_t>(components)},
                                  {"type", shape},
                                  {"normalized", normalized}});
    return static_cast<int>(json_["accessors"].size()) - 1;
  }

  int Positions(const std::vector<float>& xyz) { return Accessor(xyz, kFloat, "VEC3", 3); }

  int Mesh(const Json& primitives) {
    json_["meshes"].push_back({{"primitives", primitives}});
    return static_cast<int>(json_["meshes"].size()) - 1;
  }

  int Node(const Json& node, bool is_root = true) {
    json_["nodes"].push_back(node);
    const int index = static_cast<int>(json_["nodes"].size()) - 1;
    if (is_root) json_["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  Json& json() { return json_; }
  const std::string& data() const { return data_; }

  std::string Glb() const {
    Json json = json_;
    json["buffers"] = Json::array({{{"byteLength", data_.size()}}});
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    io::AppendLittleEndian(out, std::uint32_t{2});
    io::AppendLittleEndian(out, static_cast<std::uint32_t>(28 + text.size() + data_.size()));
    io::AppendLittleEndian(out, static_cast<std::uint32_t>(text.size()));
    out += "JSON" + text;
    io::AppendLittleEndian(out, static_cast<std::uint32_t>(data_.size()));
    return out + std::string("BIN\0", 4) + data_;
  }

  std::string Text(const std::string& uri) const {
    Json json = json_;
    json["buffers"] = Json::array({{{"byteLength", data_.size()}, {"uri", uri}}});
    return json.dump();
  }

 private:
  Json json_;
  std::string data_;
};

/// A triangle in the xy plane as mesh 0.
inline Gltf OneTriangle() {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = gltf.Accessor<std::uint16_t>({0, 1, 2}, kUshort, "SCALAR", 1);
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}));
  return gltf;
}

}  // namespace ccst::testing::gltf
