#include "client/cli/mesh_input.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/io/draco_mesh.h"
#include "tests/support/shapes.h"

namespace ccst::cli {
namespace {

class MeshInputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = ::testing::TempDir() + "ccst-mesh-input-XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Write(const TriangleMesh& mesh, const char* name) {
    const std::string path = folder_ / name;
    EXPECT_TRUE(WriteMeshFile(mesh, path).ok());
    return path;
  }

  std::filesystem::path folder_;
};

void ExpectSame(const TriangleMesh& a, const TriangleMesh& b) {
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t f = 0; f < a.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(a.positions[a.faces[f][k]], b.positions[b.faces[f][k]]) << f;
    }
  }
}

TEST_F(MeshInputTest, WireMeshIsWhatTheServerDecodes) {
  const TriangleMesh far = shapes::Moved(shapes::Icosphere(2), {1e6, 0.1, -3e6}, 0.37);
  for (const auto& [mesh, bits] :
       {std::pair(shapes::Icosphere(2), std::optional<int>()),
        {far, std::nullopt},
        {far, std::optional(12)},
        {shapes::WithIsolatedVertices(shapes::Cube(), 99), std::nullopt}}) {
    const auto input = ReadMeshInput(Write(mesh, "a.off"), bits, Transport::kRemote);
    ASSERT_TRUE(input.ok()) << input.status();
    const auto decoded = DecodeDraco(input->draco);
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    ExpectSame(*decoded, input->wire);
    EXPECT_EQ(decoded->positions.size(), input->wire.positions.size());
  }
}

TEST_F(MeshInputTest, LocalAndRemoteSampleTheSameMesh) {
  const std::string path = Write(shapes::WithIsolatedVertices(shapes::Cube(), 99), "a.obj");
  for (const std::optional<int> bits : {std::optional<int>(), std::optional(9)}) {
    const auto local = ReadMeshInput(path, bits, Transport::kLocal);
    const auto remote = ReadMeshInput(path, bits, Transport::kRemote);
    ASSERT_TRUE(local.ok() && remote.ok());
    EXPECT_EQ(local->wire.positions, remote->wire.positions);
    EXPECT_EQ(local->wire.faces, remote->wire.faces);
    EXPECT_EQ(local->origin, remote->origin);
  }
}

TEST_F(MeshInputTest, SaysWhatQuantisationCost) {
  const std::string path = Write(shapes::Icosphere(2), "a.ply");
  const auto exact = ReadMeshInput(path, std::nullopt, Transport::kRemote);
  const auto coarse = ReadMeshInput(path, 8, Transport::kRemote);
  ASSERT_TRUE(exact.ok() && coarse.ok());
  EXPECT_EQ(exact->max_move, 0.0);
  EXPECT_LT(coarse->draco.size(), exact->draco.size());
  // Half a cell of 2 / 255 in each direction at most.
  EXPECT_GT(coarse->max_move, 1e-4);
  EXPECT_LT(coarse->max_move, 0.5 * std::sqrt(3.0) * 2.0 / 255.0 + 1e-6);
}

TEST_F(MeshInputTest, ErrorsNameTheFile) {
  const auto input = ReadMeshInput(folder_ / "none.obj", std::nullopt, Transport::kLocal);
  EXPECT_EQ(input.status().code(), absl::StatusCode::kNotFound);
  EXPECT_NE(input.status().message().find("none.obj"), absl::string_view::npos);
}

TEST_F(MeshInputTest, RecognisesFormatsByTheirBytes) {
  const TriangleMesh mesh = shapes::Cube();
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kObj)), MeshFormat::kObj);
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kPly)), MeshFormat::kPly);
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kStl)), MeshFormat::kStl);
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kOff)), MeshFormat::kOff);
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kDraco)), MeshFormat::kDraco);
  EXPECT_EQ(RecogniseFormat(*EncodeMesh(mesh, MeshOutputFormat::kGlb)), MeshFormat::kGltf);
  EXPECT_EQ(RecogniseFormat("\n {\"asset\":{}}"), MeshFormat::kGltf);
  EXPECT_EQ(RecogniseFormat("solid cube\n"), MeshFormat::kStl);
  for (const char* off : {"OFF 3 1 0\n", "COFF\n", "NOFF\n", "CNOFF\n", "STOFF\n", "STCNOFF\n",
                          "# by hand\n\n  # twice\r\nOFF\n"}) {
    EXPECT_EQ(RecogniseFormat(off), MeshFormat::kOff) << off;
  }
  EXPECT_EQ(RecogniseFormat("# OFF\nv 0 0 0\n"), MeshFormat::kObj);
  EXPECT_EQ(RecogniseFormat(""), MeshFormat::kObj);
}

}  // namespace
}  // namespace ccst::cli
