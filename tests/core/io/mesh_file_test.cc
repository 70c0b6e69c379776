#include "core/io/mesh_file.h"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "core/io/numbers.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using testing::Difference;

TriangleMesh OddMesh() {
  return testing::Shuffled(testing::WithOddCoordinates(shapes::Torus(1.0, 0.35, 30, 20)), 5);
}

TriangleMesh RoundedToFloats(TriangleMesh mesh) {
  for (Eigen::Vector3d& position : mesh.positions) {
    for (double& coordinate : position) coordinate = io::RoundedToFloat(coordinate);
  }
  return mesh;
}

TEST(MeshFormat, FollowsTheExtensionInAnyCase) {
  EXPECT_EQ(MeshFormatFromPath("a/b.obj"), MeshFormat::kObj);
  EXPECT_EQ(MeshFormatFromPath("b.PLY"), MeshFormat::kPly);
  EXPECT_EQ(MeshFormatFromPath("b.x.Stl"), MeshFormat::kStl);
  EXPECT_EQ(MeshFormatFromPath("b.off"), MeshFormat::kOff);
  EXPECT_EQ(MeshFormatFromPath("b.drc"), MeshFormat::kDraco);
  EXPECT_EQ(MeshFormatFromPath("b.Glb"), MeshFormatFromPath("b.gltf"));
  EXPECT_TRUE(MeshFormatFromPath("b.gltf").has_value());
  EXPECT_EQ(MeshFormatFromPath("b.obj.GZ"), MeshFormat::kObj);
  for (const char* path : {"", "obj", "b.fbx", "b.gz", "b.fbx.gz", "b.", "drc/b"}) {
    EXPECT_FALSE(MeshFormatFromPath(path).has_value()) << path;
  }
  EXPECT_EQ(MeshOutputFormatFromPath("b.GLB"), MeshOutputFormat::kGlb);
  EXPECT_EQ(MeshOutputFormatFromPath("b.off"), MeshOutputFormat::kOff);
  EXPECT_FALSE(MeshOutputFormatFromPath("b.gltf").has_value());
}

TEST(MeshFile, FormatsOfDoublesRoundTripEveryBit) {
  TriangleMesh mesh = OddMesh();
  mesh.positions[3] = {-0.0, 5e-324, std::numeric_limits<double>::max()};
  const testing::TemporaryFolder folder;
  for (const char* name : {"m.obj", "m.ply", "m.off"}) {
    ASSERT_TRUE(WriteMeshFile(mesh, folder / name).ok()) << name;
    const auto back = ReadMeshFile(folder / name);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ("", Difference(mesh, back->mesh)) << name;
    EXPECT_TRUE(back->face_source.empty()) << name;
  }
}

TEST(MeshFile, DracoHoldsFloatsAndKeepsTheOrder) {
  const TriangleMesh mesh = OddMesh();
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(WriteMeshFile(mesh, folder / "m.drc").ok());
  const auto back = ReadMeshFile(folder / "m.drc");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ("", Difference(RoundedToFloats(mesh), back->mesh));
}

TEST(MeshFile, StlHoldsFloatsAndKeepsTheFaces) {
  const TriangleMesh mesh = RoundedToFloats(OddMesh());
  const auto bytes = EncodeMesh(mesh, MeshOutputFormat::kStl);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_EQ(bytes->size(), 84 + 50 * mesh.faces.size());
  const auto back = ReadMesh(*bytes, MeshFormat::kStl);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->mesh.positions.size(), mesh.positions.size());
  ASSERT_EQ(back->mesh.faces.size(), mesh.faces.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.positions[static_cast<std::size_t>(mesh.faces[i][k])],
                back->mesh.positions[static_cast<std::size_t>(back->mesh.faces[i][k])]);
    }
  }
}

TEST(MeshFile, VerticesOfNoFaceSurvive) {
  const TriangleMesh mesh = RoundedToFloats(shapes::WithIsolatedVertices(shapes::Cube(), 20));
  for (const auto& [output, input] : {std::pair{MeshOutputFormat::kObj, MeshFormat::kObj},
                                      std::pair{MeshOutputFormat::kPly, MeshFormat::kPly},
                                      std::pair{MeshOutputFormat::kOff, MeshFormat::kOff},
                                      std::pair{MeshOutputFormat::kDraco, MeshFormat::kDraco}}) {
    const auto bytes = EncodeMesh(mesh, output);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto back = ReadMesh(*bytes, input);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ("", Difference(mesh, back->mesh));
  }
}

// Reads what the glTF 2.0 specification says, nothing of ours but the byte helper.
TEST(MeshFile, GlbHoldsFloatsRelativeToANode) {
  const Eigen::Vector3d offset(1e7, -2e7, 0.25);
  const TriangleMesh mesh = RoundedToFloats(shapes::Moved(shapes::Icosphere(2), offset));
  const auto bytes = EncodeMesh(mesh, MeshOutputFormat::kGlb);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const auto word = [&](std::size_t at) {
    return io::LoadBytes<std::uint32_t>(bytes->data() + at, std::endian::little);
  };
  EXPECT_EQ(bytes->substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), bytes->size());
  const std::size_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0u);
  EXPECT_EQ(bytes->substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(bytes->substr(20, json_size));
  const std::size_t binary = 20 + json_size + 8;
  EXPECT_EQ(word(binary - 8), bytes->size() - binary);
  EXPECT_EQ(bytes->substr(binary - 4, 4), std::string("BIN\0", 4));

  EXPECT_EQ(json["asset"]["version"], "2.0");
  const auto& node = json["nodes"][json["scenes"][0]["nodes"][0].get<int>()];
  const auto& primitive = json["meshes"][node["mesh"].get<int>()]["primitives"][0];
  const auto& positions = json["accessors"][primitive["attributes"]["POSITION"].get<int>()];
  const auto& indices = json["accessors"][primitive["indices"].get<int>()];
  EXPECT_EQ(positions["type"], "VEC3");
  EXPECT_EQ(positions["componentType"], 5126);
  ASSERT_EQ(positions["count"], mesh.positions.size());
  EXPECT_EQ(indices["type"], "SCALAR");
  EXPECT_EQ(indices["componentType"], 5125);
  ASSERT_EQ(indices["count"], 3 * mesh.faces.size());
  EXPECT_EQ(json["buffers"][0]["byteLength"], bytes->size() - binary);

  const std::size_t position_start =
      binary + json["bufferViews"][positions["bufferView"].get<int>()]["byteOffset"].get<int>();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double relative = io::LoadBytes<float>(
          bytes->data() + position_start + 12 * i + 4 * static_cast<std::size_t>(axis),
          std::endian::little);
      low[axis] = std::min(low[axis], relative);
      EXPECT_EQ(relative + node["translation"][static_cast<std::size_t>(axis)].get<double>(),
                mesh.positions[i][axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(positions["min"][axis].get<double>(), low[static_cast<int>(axis)]);
  }
  const std::size_t index_start =
      binary + json["bufferViews"][indices["bufferView"].get<int>()]["byteOffset"].get<int>();
  for (std::size_t i = 0; i < 3 * mesh.faces.size(); ++i) {
    EXPECT_EQ(word(index_start + 4 * i), static_cast<std::uint32_t>(mesh.faces[i / 3][i % 3]));
  }
}

TEST(MeshFile, WritersRefuseWhatTheirFormatCannotHold) {
  TriangleMesh mesh = shapes::Cube();
  mesh.positions[2].y() = 1e39;
  EXPECT_REFUSED(EncodeMesh(mesh, MeshOutputFormat::kStl), ErrorReason::kMeshDegenerate, "vertex 2",
                 "32-bit");
  EXPECT_REFUSED(EncodeMesh(mesh, MeshOutputFormat::kDraco), ErrorReason::kMeshDegenerate,
                 "vertex 2", "32-bit");
  EXPECT_TRUE(EncodeMesh(mesh, MeshOutputFormat::kObj).ok());
  mesh.positions[2].y() = NAN;
  for (const auto format :
       {MeshOutputFormat::kObj, MeshOutputFormat::kPly, MeshOutputFormat::kStl,
        MeshOutputFormat::kOff, MeshOutputFormat::kDraco, MeshOutputFormat::kGlb}) {
    EXPECT_REFUSED(EncodeMesh(mesh, format), ErrorReason::kMeshDegenerate, "vertex 2");
    TriangleMesh out_of_range = shapes::Cube();
    out_of_range.faces[5][1] = 8;
    EXPECT_REFUSED(EncodeMesh(out_of_range, format), ErrorReason::kMeshDegenerate, "face 5");
  }
}

TEST(MeshFile, ErrorsNameThePath) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ReadMeshFile(folder / "none.off").status().code(), absl::StatusCode::kNotFound);
  EXPECT_NE(ReadMeshFile(folder / "none.off").status().ToString().find(folder / "none.off"),
            std::string::npos);
  ASSERT_EQ(mkdir((folder / "dir.off").c_str(), 0777), 0);
  EXPECT_EQ(ReadMeshFile(folder / "dir.off").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_REFUSED(ReadMeshFile(folder / "m.xyz"), ErrorReason::kMeshUnreadable, "m.xyz", ".gltf");
  testing::WriteBytes(folder / "bad.off", "OFF\nx\n");
  EXPECT_REFUSED(ReadMeshFile(folder / "bad.off"), ErrorReason::kMeshUnreadable, folder / "bad.off",
                 "line 2");
  testing::WriteBytes(folder / "empty.drc", "");
  EXPECT_REFUSED(ReadMeshFile(folder / "empty.drc"), ErrorReason::kMeshEmpty, "empty.drc");
  EXPECT_REFUSED(WriteMeshFile(shapes::Cube(), folder / "m.xyz"), ErrorReason::kOptionInvalid,
                 "m.xyz", ".glb");
  EXPECT_EQ(WriteMeshFile(shapes::Cube(), folder / "none/m.obj").code(),
            absl::StatusCode::kNotFound);
}

TEST(MeshFile, SizeLimitHoldsForFilesAndBytes) {
  const testing::TemporaryFolder folder;
  testing::WriteBytes(folder / "m.off", std::string(101, ' '));
  EXPECT_REFUSED(ReadMeshFile(folder / "m.off", {.max_bytes = 100}), ErrorReason::kLimitExceeded,
                 "m.off", "100 bytes");
  EXPECT_REFUSED(ReadMesh(std::string(101, ' '), MeshFormat::kOff, {.max_bytes = 100}),
                 ErrorReason::kLimitExceeded, "101 bytes");
}

}  // namespace
}  // namespace ccst
