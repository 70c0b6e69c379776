#include "core/io/glb_writer.h"

#include <cstdint>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

// Values of the glTF 2.0 specification.
constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr int kTriangles = 4;

nlohmann::json ToJson(const Eigen::Vector3d& vector) {
  return nlohmann::json::array({vector.x(), vector.y(), vector.z()});
}

std::string Describe(const TriangleMesh& relative, const Eigen::Vector3d& origin) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : relative.positions) box.extend(position);
  const std::size_t vertices = relative.positions.size();
  const std::size_t corners = 3 * relative.faces.size();
  const std::size_t position_bytes = 12 * vertices;
  using Json = nlohmann::json;
  Json node = {{"mesh", 0}};
  if (!origin.isZero(0.0)) node["translation"] = ToJson(origin);
  // Arrays are spelled out: compilers differ on what braces around one value mean.
  const Json primitive = {{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"mode", kTriangles}};
  const Json positions = {{"bufferView", 0},          {"componentType", kFloat},
                          {"count", vertices},        {"type", "VEC3"},
                          {"min", ToJson(box.min())}, {"max", ToJson(box.max())}};
  const Json indices = {
      {"bufferView", 1}, {"componentType", kUnsignedInt}, {"count", corners}, {"type", "SCALAR"}};
  const Json position_view = {
      {"buffer", 0}, {"byteOffset", 0}, {"byteLength", position_bytes}, {"target", kArrayBuffer}};
  const Json index_view = {{"buffer", 0},
                           {"byteOffset", position_bytes},
                           {"byteLength", 4 * corners},
                           {"target", kElementArrayBuffer}};
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "ccst"}};
  document["scene"] = 0;
  document["scenes"].push_back({{"nodes", Json::array({0})}});
  document["nodes"].push_back(node);
  document["meshes"].push_back({{"primitives", Json::array({primitive})}});
  document["accessors"] = Json::array({positions, indices});
  document["bufferViews"] = Json::array({position_view, index_view});
  document["buffers"].push_back({{"byteLength", position_bytes + 4 * corners}});
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');  // Chunks are aligned to four bytes.
  return text;
}

}  // namespace

absl::StatusOr<std::string> EncodeGlb(const TriangleMesh& mesh) {
  if (mesh.faces.empty()) return Empty("the mesh has no faces; glTF needs one");
  const Eigen::Vector3d origin = ChooseOrigin(mesh);
  CCST_ASSIGN_OR_RETURN(const TriangleMesh relative, ToWirePrecision(mesh, origin));
  const std::string json = Describe(relative, origin);
  const std::size_t binary_bytes = 12 * (relative.positions.size() + relative.faces.size());
  const std::size_t total = 12 + 8 + json.size() + 8 + binary_bytes;
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    return OverLimit(absl::StrCat(total, " bytes; a GLB file has at most 4294967295"));
  }
  std::string out;
  out.reserve(total);
  AppendLittleEndian(out, kMagic);
  AppendLittleEndian(out, std::uint32_t{2});
  AppendLittleEndian(out, static_cast<std::uint32_t>(total));
  AppendLittleEndian(out, static_cast<std::uint32_t>(json.size()));
  AppendLittleEndian(out, kJsonChunk);
  out += json;
  AppendLittleEndian(out, static_cast<std::uint32_t>(binary_bytes));
  AppendLittleEndian(out, kBinChunk);
  for (const Eigen::Vector3d& position : relative.positions) {
    for (const double value : position) AppendLittleEndian(out, static_cast<float>(value));
  }
  for (const Eigen::Vector3i& face : relative.faces) {
    for (const int corner : face) AppendLittleEndian(out, static_cast<std::uint32_t>(corner));
  }
  return out;
}

}  // namespace ccst::io
