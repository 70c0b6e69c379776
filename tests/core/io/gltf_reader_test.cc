#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"
#include "tests/core/io/gltf_file.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using namespace testing::gltf;  // NOLINT: the pieces of a file, all over these tests.
using ::testing::ElementsAre;

absl::StatusOr<MeshFile> Read(const std::string& bytes) {
  return ReadMesh(bytes, MeshFormat::kGltf);
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

TEST(GltfReader, AttributesOfAnApplication) {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int heat = gltf.Accessor<float>({0.5F, -2, 1e9F}, kFloat, "SCALAR", 1);
  const int share =
      gltf.Accessor<std::uint16_t>({0, 65535, 13107}, kUshort, "SCALAR", 1, /*normalized=*/true);
  const int flow = gltf.Accessor<std::int8_t>({127, -127, 0, -128, 1, 2, 3, 4, 5}, kByte, "VEC3", 3,
                                              /*normalized=*/true);
  const int label = gltf.Accessor<std::uint32_t>({7, 0, 70000}, kUint, "SCALAR", 1);
  const int pair = gltf.Accessor<float>({1, 2, 3, 4, 5, 6}, kFloat, "VEC2", 2);
  const int matrix = gltf.Accessor<float>(std::vector<float>(12), kFloat, "MAT2", 4);
  gltf.Mesh(Json::array({{{"attributes",
                           {{"POSITION", positions},
                            {"NORMAL", positions},
                            {"_HEAT", heat},
                            {"_share", share},
                            {"_FLOW", flow},
                            {"_LABEL", label},
                            {"_PAIR", pair},
                            {"_MATRIX", matrix},
                            {"COLOR_1", positions},
                            {"TEXCOORD_1", pair}}}}}));
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  const auto expect = [&](const std::string& name, AttributeKind kind, int components,
                          const std::vector<float>& values) {
    const Attribute* const attribute = FindAttribute(file->mesh.attributes, name);
    ASSERT_NE(attribute, nullptr) << name;
    EXPECT_EQ(attribute->kind, kind) << name;
    EXPECT_EQ(attribute->components, components) << name;
    EXPECT_EQ(attribute->values, values) << name;
  };
  EXPECT_EQ(file->mesh.attributes.size(), 7u);
  expect("HEAT", AttributeKind::kScalar, 1, {0.5F, -2, 1e9F});
  expect("share", AttributeKind::kScalar, 1, {0, 1, 0.2F});
  const float step = 1.0F / 127;
  expect("FLOW", AttributeKind::kScalar, 3,
         {1, -1, 0, -1, step, 2 / 127.0F, 3 / 127.0F, 4 / 127.0F, 5 / 127.0F});
  expect("LABEL", AttributeKind::kLabel, 1, {7, 0, 70000});
  expect("PAIR", AttributeKind::kScalar, 2, {1, 2, 3, 4, 5, 6});
  expect("color", AttributeKind::kColor, 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  expect("uv", AttributeKind::kTextureCoordinates, 2, {1, -1, 3, -3, 5, -5});
  EXPECT_TRUE(CheckAttributes(file->mesh).ok());
}

TEST(GltfReader, AttributesThatAPrimitiveLacksAreZero) {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int heat = gltf.Accessor<float>({1, 2, 3}, kFloat, "SCALAR", 1);
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}},
                         {{"attributes", {{"POSITION", positions}, {"_HEAT", heat}}}},
                         {{"attributes", {{"POSITION", positions}}}}}));
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  EXPECT_THAT(file->mesh.attributes[0].values, ElementsAre(0, 0, 0, 1, 2, 3, 0, 0, 0));
}

TEST(GltfReader, AttributesOfTheWrongShapeArePassedOver) {
  const auto read = [](const std::string& key, const std::vector<float>& values,
                       const std::string& shape, int components) {
    Gltf gltf;
    const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int attribute = gltf.Accessor<float>(values, kFloat, shape, components);
    const int heat = gltf.Accessor<float>({1, 2, 3}, kFloat, "SCALAR", 1);
    gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}, {"_HEAT", heat}}}},
                           {{"attributes", {{"POSITION", positions}, {key, attribute}}}}}));
    gltf.Node({{"mesh", 0}});
    return Read(gltf.Glb());
  };
  const auto expect_ignored = [](const absl::StatusOr<MeshFile>& file, const std::string& part) {
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->mesh.faces.size(), 2u);
    EXPECT_EQ(file->mesh.attributes.size(), 1u);  // HEAT of the first primitive.
    EXPECT_TRUE(CheckAttributes(file->mesh).ok());
    EXPECT_THAT(file->report.ignored, ElementsAre(::testing::HasSubstr(part)));
  };
  expect_ignored(read("COLOR_0", {1, 2, 3}, "SCALAR", 1), "'COLOR_0' has rows of 1");
  expect_ignored(read("TEXCOORD_0", {1, 2, 3}, "SCALAR", 1), "'TEXCOORD_0' has rows of 1");
  expect_ignored(read("_HEAT", {1, 2, 3, 4, 5, 6}, "VEC2", 2), "before it has 1");
  expect_ignored(read("_COLD", {1, 2}, "SCALAR", 1), "'_COLD' (it has 2 rows for 3 vertices)");
}

TEST(GltfReader, ManyKeysForTheSameNumbersAreBounded) {
  Gltf gltf;
  const std::size_t vertices = 30000;
  const int positions = gltf.Positions(std::vector<float>(3 * vertices));
  const int shared =
      gltf.Accessor<std::uint8_t>(std::vector<std::uint8_t>(4 * vertices), kUbyte, "VEC4", 4);
  Json attributes = {{"POSITION", positions}};
  for (std::size_t i = 0; i < kMaxAttributes; ++i) attributes[absl::StrCat("_", i)] = shared;
  Json primitive = {{"attributes", attributes}};
  gltf.Mesh(Json::array({primitive}));
  gltf.Node({{"mesh", 0}});
  const MeshLimits limits = {.max_decoded_bytes = 16 << 20};
  EXPECT_REFUSED(ReadMesh(gltf.Glb(), MeshFormat::kGltf, limits), ErrorReason::kLimitExceeded,
                 "bytes, the most accepted");
  const std::string bytes = gltf.Glb();
  const auto growth =
      testing::PeakGrowth([&] { (void)ReadMesh(bytes, MeshFormat::kGltf, limits); });
  EXPECT_GE(growth, 0);
  EXPECT_LT(growth, 64 << 20);
  attributes["_one_more"] = shared;
  primitive["attributes"] = attributes;
  gltf.json()["meshes"][0]["primitives"][0] = primitive;
  EXPECT_REFUSED(Read(gltf.Glb()), ErrorReason::kLimitExceeded, "more than 64");
}

TEST(GltfReader, DracoPrimitivesMayGiveOneAttributeManyNames) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.attributes = {{.name = "heat", .values = {1, 2, 3, 4}}};
  const auto read = [&mesh](const Json& keys) {
    Gltf gltf;
    const int view = gltf.View(EncodeDraco(mesh).value());
    Json extension = {{"bufferView", view}, {"attributes", keys}};
    gltf.Mesh(Json::array({{{"attributes", {{"POSITION", 0}}},
                            {"extensions", {{"KHR_draco_mesh_compression", extension}}}}}));
    gltf.Node({{"mesh", 0}});
    return Read(gltf.Glb());
  };
  const auto file = read({{"POSITION", 0}, {"_A", 1}, {"_B", 1}, {"_NONE", 9}});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 2u);
  EXPECT_EQ(file->mesh.attributes[0].name, "A");
  EXPECT_EQ(file->mesh.attributes[0].values, file->mesh.attributes[1].values);
  for (std::size_t c = 0; c < 12; ++c) {
    EXPECT_EQ(file->mesh.attributes[1].values[c],
              1.0F + static_cast<float>(mesh.faces[c / 3][static_cast<int>(c % 3)]));
  }
  const auto odd = read({{"POSITION", 0}, {"TEXCOORD_0", 1}});
  ASSERT_TRUE(odd.ok()) << odd.status();
  EXPECT_THAT(odd->report.ignored, ElementsAre(::testing::HasSubstr("'TEXCOORD_0' has rows of 1")));
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
  for (const char* uri : {"../secret.bin", "..%2fsecret.bin", "b/../../secret.bin", "/etc/passwd",
                          "..\\\\secret.bin", "http://example.com/a.bin", "file:///a.bin"}) {
    testing::WriteBytes(folder / "in/a.gltf", gltf.Text(uri));
    EXPECT_REFUSED(ReadMeshFile(folder / "in/a.gltf"), ErrorReason::kMeshUnreadable,
                   "the mesh's folder or below");
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
  refused([](Json& j) { j["accessors"][0]["sparse"] = {{"count", 1}}; }, "no -1 in 'bufferViews'");
  refused(
      [](Json& j) {
        j["accessors"][0].erase("bufferView");
        j["accessors"][0]["count"] = 9007199254740992ULL;
      },
      "no buffer view");
  refused([](Json& j) { j["accessors"][0]["count"] = 4; }, "4 rows");
  refused([](Json& j) { j["accessors"][0]["count"] = 9007199254740992ULL; }, "do not fit");
  refused([](Json& j) { j["accessors"][0]["byteOffset"] = 4; }, "do not fit");
  refused([](Json& j) { j["accessors"][0]["type"] = "MAT4"; }, "not known");
  refused([](Json& j) { j["accessors"][0]["componentType"] = 1; }, "not known");
  refused([](Json& j) { j["accessors"][0]["count"] = -1; }, "whole number");
  refused([](Json& j) { j["accessors"][0]["bufferView"] = 17; }, "no 17 in 'bufferViews'");
  refused([](Json& j) { j["bufferViews"][0]["byteLength"] = 1 << 20; }, "ends behind its buffer");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }, "mode 7");
  refused([](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 0; }, "unsigned SCALARs");
  refused([](Json& j) { j["accessors"][1]["count"] = 2; }, "whole triangles");
  refused([](Json& j) { j["nodes"][0]["children"] = {0}; }, "twice");
  refused([](Json& j) { j["nodes"][0]["matrix"] = {1, 2}; }, "16 numbers");
  refused([](Json& j) { j["nodes"][0]["mesh"] = 3; }, "no 3 in 'meshes'");
  refused([](Json& j) { j["scenes"] = 5; }, "scenes");
  refused([](Json& j) { j["nodes"] = 5; }, "nodes");
  refused([](Json& j) { j["extensionsRequired"] = {"EXT_of_nobody"}; }, "EXT_of_nobody");
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
