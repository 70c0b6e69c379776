#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;

constexpr int kUbyte = 5121;
constexpr int kUshort = 5123;
constexpr int kFloat = 5126;

// A glTF file put together piece by piece: one scene, whose nodes are added last.
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

absl::StatusOr<MeshFile> Read(const std::string& bytes) {
  return ReadMesh(bytes, MeshFormat::kGltf);
}

// A triangle in the xy plane as mesh 0.
Gltf OneTriangle() {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = gltf.Accessor<std::uint16_t>({0, 1, 2}, kUshort, "SCALAR", 1);
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}));
  return gltf;
}

TEST(GltfReader, ReadsWhatIsWritten) {
  for (const Eigen::Vector3d& offset : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e6, -3e5, 0)}) {
    const TriangleMesh mesh = testing::Shuffled(shapes::Moved(shapes::Icosphere(3), offset), 3);
    const auto file = Read(EncodeMesh(mesh, MeshOutputFormat::kGlb).value());
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->mesh.faces, mesh.faces);
    ASSERT_EQ(file->mesh.positions.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_LT((file->mesh.positions[i] - mesh.positions[i]).norm(), 1e-6);
    }
    EXPECT_TRUE(file->mesh.attributes.empty());
    EXPECT_TRUE(file->face_source.empty());
  }
}

TEST(GltfReader, NodesMoveTheirMeshesInSceneOrder) {
  Gltf gltf = OneTriangle();
  // 90 degrees about z, then twice as large, then moved by the parent.
  const double h = std::sqrt(0.5);
  const int child =
      gltf.Node({{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"scale", {2, 2, 2}}}, false);
  gltf.Node({{"translation", {10, 0, 0}}, {"mesh", 0}, {"children", {child}}});
  gltf.Node({{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1}}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(3, 4, 5),
                                            Eigen::Vector3i(6, 7, 8)));
  const Eigen::Vector3d expected[] = {{10, 0, 0}, {11, 0, 0}, {10, 1, 0}, {10, 0, 0}, {10, 2, 0},
                                      {8, 0, 0},  {0, 0, 7},  {1, 0, 7},  {0, 1, 7}};
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_LT((file->mesh.positions[i] - expected[i]).norm(), 1e-12) << i;
  }
}

TEST(GltfReader, MirroredPartsKeepTheirOutside) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}, {"scale", {1, 1, -1}}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 2, 1)));
}

TEST(GltfReader, ColoursAndTextureCoordinatesOfSomePrimitives) {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int color = gltf.Accessor<std::uint8_t>({255, 0, 51, 255, 0, 102, 0, 0, 0, 0, 255, 51},
                                                kUbyte, "VEC4", 4, true);
  const int uv = gltf.Accessor<float>({0, 0, 1, 0.25F, 0.5F, 1}, kFloat, "VEC2", 2);
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}},
                         {{"attributes", {{"POSITION", positions}, {"COLOR_0", color}}}},
                         {{"attributes", {{"POSITION", positions}}}, {"mode", 1}},
                         {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}}}}));
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 3u);
  const Attribute* const colors = FindAttribute(file->mesh.attributes, "color");
  const Attribute* const coordinates = FindAttribute(file->mesh.attributes, "uv");
  ASSERT_TRUE(colors != nullptr && coordinates != nullptr);
  EXPECT_EQ(colors->components, 4);
  EXPECT_EQ(colors->values, (std::vector<float>{1, 1, 1,    1, 1, 1,    1, 1, 1, 1, 1, 1,     //
                                                1, 0, 0.2F, 1, 0, 0.4F, 0, 0, 0, 0, 1, 0.2F,  //
                                                1, 1, 1,    1, 1, 1,    1, 1, 1, 1, 1, 1}));
  // glTF counts v from the top of the image.
  EXPECT_EQ(coordinates->values, (std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  //
                                                     0, 1, 1, 0.75F, 0.5F, 0}));
  EXPECT_TRUE(CheckAttributes(file->mesh).ok());
}

TEST(GltfReader, DracoPrimitives) {
  TriangleMesh mesh = shapes::Icosphere(1);
  Attribute height{.name = "h", .kind = AttributeKind::kColor, .components = 3};
  for (const Eigen::Vector3d& p : mesh.positions) {
    for (const double value : p) height.values.push_back(static_cast<float>(value));
  }
  mesh.attributes = {{.name = "other", .values = std::vector<float>(mesh.positions.size())},
                     height};
  Gltf gltf;
  const int view = gltf.View(EncodeDraco(mesh).value());
  gltf.Mesh(Json::array(
      {{{"attributes", {{"POSITION", 0}}},
        {"extensions",
         {{"KHR_draco_mesh_compression",
           {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"COLOR_0", 2}}}}}}}}}));
  gltf.Node({{"mesh", 0}});
  gltf.json()["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces, mesh.faces);
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  const Attribute& color = file->mesh.attributes[0];
  EXPECT_EQ(color.name, "color");
  for (std::size_t c = 0; c < 3 * mesh.faces.size(); ++c) {
    const Eigen::Vector3d& p = mesh.positions[mesh.faces[c / 3][static_cast<int>(c % 3)]];
    EXPECT_EQ(color.values[3 * c + 2], static_cast<float>(p.z()));
  }
}

TEST(GltfReader, BuffersInDataUrisAndBesideTheFile) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const std::string base64 = absl::Base64Escape(gltf.data());
  EXPECT_TRUE(Read(gltf.Text("data:application/octet-stream;base64," + base64)).ok());
  const testing::TemporaryFolder folder;
  testing::WriteBytes(folder / "a b.bin", gltf.data());
  testing::WriteBytes(folder / "a.gltf", gltf.Text("a%20b.bin"));
  const auto file = ReadMeshFile(folder / "a.gltf");
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 1u);
  EXPECT_REFUSED(Read(gltf.Text("a%20b.bin")), ErrorReason::kMeshUnreadable, "another file");
}

TEST(GltfReader, NothingElseIsOpened) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const testing::TemporaryFolder folder;
  testing::WriteBytes(folder / "secret.bin", gltf.data());
  ASSERT_EQ(system(("mkdir " + (folder / "in")).c_str()), 0);
  for (const char* uri : {"../secret.bin", "..%2fsecret.bin", "/etc/passwd", "secret.txt",
                          "http://example.com/a.bin", "file:///a.bin"}) {
    testing::WriteBytes(folder / "in/a.gltf", gltf.Text(uri));
    EXPECT_REFUSED(ReadMeshFile(folder / "in/a.gltf"), ErrorReason::kMeshUnreadable,
                   "in the same folder");
  }
}

TEST(GltfReader, OddAccessorsAreRefused) {
  const auto refused = [](const std::function<void(Json&)>& change, const std::string& part) {
    Gltf gltf = OneTriangle();
    gltf.Node({{"mesh", 0}});
    change(gltf.json());
    const auto file = Read(gltf.Glb());
    EXPECT_FALSE(file.ok()) << part;
    EXPECT_NE(std::string(file.status().message()).find(part), std::string::npos) << file.status();
  };
  refused([](Json& j) { j["accessors"][0]["sparse"] = {{"count", 1}}; }, "sparse");
  refused([](Json& j) { j["accessors"][0].erase("bufferView"); }, "no buffer view");
  refused([](Json& j) { j["accessors"][0]["count"] = 4; }, "4 rows");
  refused([](Json& j) { j["accessors"][0]["count"] = 9007199254740992ULL; }, "do not fit");
  refused([](Json& j) { j["accessors"][0]["byteOffset"] = 4; }, "do not fit");
  refused([](Json& j) { j["accessors"][0]["type"] = "MAT4"; }, "not known");
  refused([](Json& j) { j["accessors"][0]["componentType"] = 1; }, "not known");
  refused([](Json& j) { j["accessors"][0]["count"] = -1; }, "whole number");
  refused([](Json& j) { j["accessors"][0]["bufferView"] = 17; }, "no 17 in 'bufferViews'");
  refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 1 << 20; }, "ends behind its buffer");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 5; }, "strips");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }, "unsigned SCALARs");
  refused([](Json& j) { j["accessors"][1]["count"] = 2; }, "whole triangles");
  refused([](Json& j) { j["nodes"][0]["children"] = {0}; }, "twice");
  refused([](Json& j) { j["nodes"][0]["matrix"] = {1, 2}; }, "16 numbers");
  refused([](Json& j) { j["nodes"][0]["mesh"] = 3; }, "no 3 in 'meshes'");
  refused([](Json& j) { j["scenes"] = 5; }, "scenes");
  refused([](Json& j) { j["nodes"] = 5; }, "nodes");
  refused([](Json& j) { j["extensionsRequired"] = {"EXT_meshopt_compression"}; },
          "EXT_meshopt_compression");
}

TEST(GltfReader, IndicesOutOfRangeAreRefused) {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = gltf.Accessor<std::uint8_t>({0, 1, 3}, kUbyte, "SCALAR", 1);
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}));
  gltf.Node({{"mesh", 0}});
  EXPECT_REFUSED(Read(gltf.Glb()), ErrorReason::kMeshDegenerate, "mesh 0, primitive 0", "vertex 3");
}

TEST(GltfReader, LimitsHold) {
  Gltf gltf = OneTriangle();
  for (int i = 0; i < 5; ++i) gltf.Node({{"mesh", 0}});
  EXPECT_REFUSED(ReadMesh(gltf.Glb(), MeshFormat::kGltf, {.max_vertices = 14}),
                 ErrorReason::kLimitExceeded, "14 vertices");
  EXPECT_REFUSED(ReadMesh(gltf.Glb(), MeshFormat::kGltf, {.max_faces = 4}),
                 ErrorReason::kLimitExceeded, "4 triangles");
}

TEST(GltfReader, DamagedFilesGiveAMeshOrARefusal) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}, {"translation", {1, 2, 3}}});
  const std::string bytes = gltf.Glb();
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    EXPECT_FALSE(Read(bytes.substr(0, size)).ok()) << size;
  }
  std::mt19937 random(4);
  for (int round = 0; round < 4000; ++round) {
    std::string damaged = bytes;
    for (int k = 0; k < 2; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    const auto file = Read(damaged);
    EXPECT_TRUE(file.ok() || GetErrorReason(file.status()).has_value()) << file.status();
  }
  EXPECT_REFUSED(Read("{" + std::string(100'000, '[')), ErrorReason::kMeshUnreadable, "JSON");
  EXPECT_REFUSED(Read("{}"), ErrorReason::kMeshUnreadable, "asset");
}

}  // namespace
}  // namespace ccst
