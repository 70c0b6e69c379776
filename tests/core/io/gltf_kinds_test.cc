#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "core/mesh/attributes.h"
#include "tests/core/io/gltf_file.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

// What glTF files may be made of besides lists of triangles in a scene.
namespace ccst {
namespace {

using namespace testing::gltf;  // NOLINT: the pieces of a file, all over these tests.
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<MeshFile> Read(const std::string& bytes) {
  return ReadMesh(bytes, MeshFormat::kGltf);
}

Gltf OfMode(int mode) {
  Gltf gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", positions}}}, {"mode", mode}}}));
  gltf.Node({{"mesh", 0}});
  return gltf;
}

TEST(GltfKinds, StripsAlternateTheirSense) {
  const auto file = Read(OfMode(5).Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(1, 3, 2),
                                            Eigen::Vector3i(2, 3, 4)));
}

TEST(GltfKinds, FansTurnAroundTheirFirstCorner) {
  const auto file = Read(OfMode(6).Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(1, 2, 0), Eigen::Vector3i(2, 3, 0),
                                            Eigen::Vector3i(3, 4, 0)));
}

TEST(GltfKinds, WithoutScenesTheNodesThatAreNoChildrenAreShown) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}}, /*is_root=*/false);
  gltf.Node({{"children", {0}}, {"translation", {5, 0, 0}}}, /*is_root=*/false);
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.faces.size(), 1u);
  EXPECT_EQ(file->mesh.positions[0], Eigen::Vector3d(5, 0, 0));
}

TEST(GltfKinds, WithoutNodesEveryMeshIsShownOnce) {
  const auto file = Read(OneTriangle().Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 1u);
}

TEST(GltfKinds, SparseValuesTakeTheirPlaces) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const int rows = gltf.Accessor<std::uint16_t>({1}, kUshort, "SCALAR", 1);
  const int values = gltf.Accessor<float>({7, 8, 9}, kFloat, "VEC3", 3);
  Json& json = gltf.json();
  const Json sparse = {
      {"count", 1},
      {"indices",
       {{"bufferView", json["accessors"][rows]["bufferView"]}, {"componentType", kUshort}}},
      {"values", {{"bufferView", json["accessors"][values]["bufferView"]}}}};
  json["accessors"][0]["sparse"] = sparse;
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.positions, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(7, 8, 9),
                                                Eigen::Vector3d(0, 1, 0)));
  // Without a buffer view all other rows are zeros.
  json["accessors"][0].erase("bufferView");
  const auto zeros = Read(gltf.Glb());
  ASSERT_TRUE(zeros.ok()) << zeros.status();
  EXPECT_EQ(zeros->mesh.positions[2], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(zeros->mesh.positions[1], Eigen::Vector3d(7, 8, 9));
}

TEST(GltfKinds, SparseRowsOutOfRangeAreRefused) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const int rows = gltf.Accessor<std::uint16_t>({3}, kUshort, "SCALAR", 1);
  Json& json = gltf.json();
  json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices",
       {{"bufferView", json["accessors"][rows]["bufferView"]}, {"componentType", kUshort}}},
      {"values", {{"bufferView", json["accessors"][0]["bufferView"]}}}};
  EXPECT_REFUSED(Read(gltf.Glb()), ErrorReason::kMeshUnreadable, "row 3 of 3");
}

TEST(GltfKinds, AttributesThatCannotBeReadAreSaidToBePassedOver) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const int two = gltf.Accessor<float>({1, 2}, kFloat, "SCALAR", 1);
  gltf.json()["meshes"][0]["primitives"][0]["attributes"]["_BATCHID"] = two;
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->mesh.attributes.empty());
  EXPECT_THAT(file->report.ignored, Contains(HasSubstr("_BATCHID")));
}

TEST(GltfKinds, InstancesAreExpandedWithinTheirNode) {
  Gltf gltf = OneTriangle();
  const int translations = gltf.Positions({10, 0, 0, 20, 0, 0});
  const int scales = gltf.Positions({1, 1, 1, 2, 2, 2});
  gltf.Node({{"mesh", 0},
             {"translation", {0, 0, 3}},
             {"extensions",
              {{"EXT_mesh_gpu_instancing",
                {{"attributes", {{"TRANSLATION", translations}, {"SCALE", scales}}}}}}}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 2u);
  EXPECT_EQ(file->mesh.positions[1], Eigen::Vector3d(11, 0, 3));
  EXPECT_EQ(file->mesh.positions[4], Eigen::Vector3d(22, 0, 3));
}

TEST(GltfKinds, InstancesWithoutEndAreRefused) {
  Gltf gltf = OneTriangle();
  gltf.json()["accessors"].push_back(
      {{"componentType", kFloat}, {"count", 100'000'000}, {"type", "VEC3"}});
  gltf.Node(
      {{"mesh", 0},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 2}}}}}}}});
  EXPECT_REFUSED(Read(gltf.Glb()), ErrorReason::kLimitExceeded, "1000000 meshes");
}

TEST(GltfKinds, MorphTargetsSkinsAndLinesAreSaidToBePassedOver) {
  Gltf gltf = OneTriangle();
  Json& primitives = gltf.json()["meshes"][0]["primitives"];
  primitives[0]["targets"] = {{{"POSITION", 0}}, {{"POSITION", 0}}};
  primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  gltf.Node({{"mesh", 0}, {"skin", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->report.ignored,
              ElementsAre("2 morph targets", "1 primitives of points or lines", "1 skins"));
}

TEST(GltfKinds, DracoStreamsOfIntegersHonourNormalized) {
  // A stream as quantizing tools write: 16-bit integers that stand for fractions.
  const TriangleMesh sphere = shapes::Icosphere(2);
  TriangleMesh integers = sphere;
  for (Eigen::Vector3d& position : integers.positions) {
    position = (32767.0 * position.normalized()).array().round();
  }
  Gltf gltf;
  const int view = gltf.View(EncodeDraco(integers).value());
  gltf.json()["accessors"].push_back({{"componentType", 5122},
                                      {"count", integers.positions.size()},
                                      {"type", "VEC3"},
                                      {"normalized", true}});
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", 0}}},
                          {"extensions",
                           {{"KHR_draco_mesh_compression",
                             {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}}}));
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  for (const Eigen::Vector3d& position : file->mesh.positions) {
    EXPECT_NEAR(position.norm(), 1.0, 1e-4);
  }
}

TEST(GltfKinds, MeshoptBuffersAreDecoded) {
  const TriangleMesh sphere = shapes::Icosphere(3);
  std::vector<float> xyz;
  for (const Eigen::Vector3d& p : sphere.positions) {
    for (const double value : p) xyz.push_back(static_cast<float>(value));
    xyz.push_back(0.0F);  // Rows of meshopt are whole words; this one is skipped by the type.
  }
  std::vector<std::uint32_t> corners;
  for (const Eigen::Vector3i& face : sphere.faces) {
    for (const int corner : face) corners.push_back(static_cast<std::uint32_t>(corner));
  }
  const std::size_t count = sphere.positions.size();
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(count, 16));
  vertices.resize(
      meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), xyz.data(), count, 16));
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(corners.size(), count));
  indices.resize(
      meshopt_encodeIndexBuffer(indices.data(), indices.size(), corners.data(), corners.size()));
  Gltf gltf;
  const auto add = [&gltf](const std::vector<unsigned char>& bytes, std::size_t rows, int stride,
                           const char* mode) {
    const int view = gltf.View(std::string(bytes.begin(), bytes.end()), 0);
    Json& json = gltf.json()["bufferViews"][static_cast<std::size_t>(view)];
    json["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                     {"byteOffset", json["byteOffset"]},
                                                     {"byteLength", json["byteLength"]},
                                                     {"byteStride", stride},
                                                     {"count", rows},
                                                     {"mode", mode}};
    json["byteLength"] = rows * static_cast<std::size_t>(stride);
    json["byteStride"] = stride;
    return view;
  };
  const int position_view = add(vertices, count, 16, "ATTRIBUTES");
  const int index_view = add(indices, corners.size(), 4, "TRIANGLES");
  gltf.json()["bufferViews"][static_cast<std::size_t>(index_view)].erase("byteStride");
  gltf.json()["accessors"] = {{{"bufferView", position_view},
                               {"componentType", kFloat},
                               {"count", count},
                               {"type", "VEC3"}},
                              {{"bufferView", index_view},
                               {"componentType", kUint},
                               {"count", corners.size()},
                               {"type", "SCALAR"}}};
  gltf.json()["extensionsRequired"] = {"EXT_meshopt_compression"};
  gltf.Mesh(Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}));
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.positions.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_LT((file->mesh.positions[i] - sphere.positions[i]).norm(), 1e-6);
  }
  EXPECT_EQ(file->mesh.faces.size(), sphere.faces.size());
  // What announces more than its bytes can hold takes no memory.
  Json& extension = gltf.json()["bufferViews"][static_cast<std::size_t>(position_view)]
                               ["extensions"]["EXT_meshopt_compression"];
  extension["count"] = 100'000'000;
  EXPECT_REFUSED(Read(gltf.Glb()), ErrorReason::kMeshUnreadable, "damaged");
}

TEST(GltfKinds, TextureTransformsOfTheBaseColourMoveTextureCoordinates) {
  Gltf gltf = OneTriangle();
  const int uv = gltf.Accessor<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 2);
  Json& primitive = gltf.json()["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = uv;
  primitive["material"] = 0;
  gltf.json()["materials"] = Json::array(
      {{{"pbrMetallicRoughness",
         {{"baseColorTexture",
           {{"index", 0},
            {"extensions",
             {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}, {"scale", {0.5, 2}}}}}}}}}}}});
  gltf.Node({{"mesh", 0}});
  const auto file = Read(gltf.Glb());
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  // v counts from below here, from above in the file.
  EXPECT_THAT(file->mesh.attributes[0].values, ElementsAre(0.25F, 0.5F, 0.75F, 0.5F, 0.25F, -1.5F));
}

TEST(GltfKinds, BuffersMayLieInFoldersBelow) {
  Gltf gltf = OneTriangle();
  gltf.Node({{"mesh", 0}});
  const testing::TemporaryFolder folder;
  ASSERT_EQ(system(("mkdir " + (folder / "buffers")).c_str()), 0);
  testing::WriteBytes(folder / "buffers/a.bin", gltf.data());
  testing::WriteBytes(folder / "b.data", gltf.data());
  for (const char* uri : {"buffers/a.bin", "./buffers/a.bin", "./b.data"}) {
    testing::WriteBytes(folder / "a.gltf", gltf.Text(uri));
    EXPECT_TRUE(ReadMeshFile(folder / "a.gltf").ok()) << uri;
  }
}

}  // namespace
}  // namespace ccst
