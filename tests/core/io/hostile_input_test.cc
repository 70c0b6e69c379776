// Every reader against files that were cut or damaged: a mesh or a refusal with a reason, no more.
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/io/mesh_file.h"
#include "core/mesh/attributes.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

struct Sample {
  std::string name;
  MeshFormat format;
  std::string bytes;
};

std::vector<Sample> SmallFiles() {
  const TriangleMesh mesh = shapes::Tetrahedron();
  TriangleMesh rich = mesh;
  rich.attributes = {{.name = "color",
                      .kind = AttributeKind::kColor,
                      .components = 3,
                      .values = std::vector<float>(12, 0.5F)},
                     {.name = "uv",
                      .kind = AttributeKind::kTextureCoordinates,
                      .components = 2,
                      .values = std::vector<float>(8, 0.25F)},
                     {.name = "heat", .values = {1, 2, 3, 4}}};
  return {
      {"obj", MeshFormat::kObj, EncodeMesh(mesh, MeshOutputFormat::kObj).value()},
      {"obj with everything", MeshFormat::kObj,
       "# c\nv 0 0 0 \\\n 1\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvt 0 0\nf 1/1/1 -1//1 3 2\nf 1 2 3\n"},
      {"off", MeshFormat::kOff, EncodeMesh(mesh, MeshOutputFormat::kOff).value()},
      {"off with colours", MeshFormat::kOff,
       "COFF # c\n4 2 0\n0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n1 1 1 0 0 0\n4 0 1 2 3 9\n3 0 1 "
       "2\n"},
      {"off with everything", MeshFormat::kOff,
       "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 8 7 6 .5 1\n1 0 0 0 0 1 0 1 0 0 0\n0 1 0 0 0 1\n3 0 1 2\n"},
      {"ply with attributes", MeshFormat::kPly, EncodeMesh(rich, MeshOutputFormat::kPly).value()},
      {"glb with attributes", MeshFormat::kGltf, EncodeMesh(rich, MeshOutputFormat::kGlb).value()},
      {"draco with attributes", MeshFormat::kDraco,
       EncodeMesh(rich, MeshOutputFormat::kDraco).value()},
      {"binary ply", MeshFormat::kPly, EncodeMesh(mesh, MeshOutputFormat::kPly).value()},
      {"text ply", MeshFormat::kPly,
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nproperty list uchar int extra\nelement face 1\n"
       "property list uchar int vertex_indices\nend_header\n0 0 0 0\n1 0 0 1 5\n0 1 0 0\n3 0 1 "
       "2\n"},
      {"binary stl", MeshFormat::kStl, EncodeMesh(mesh, MeshOutputFormat::kStl).value()},
      {"text stl", MeshFormat::kStl,
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
       "endloop\nendfacet\nendsolid a\n"},
      {"draco", MeshFormat::kDraco, EncodeMesh(mesh, MeshOutputFormat::kDraco).value()},
  };
}

// What is wrong with a result; empty for a valid mesh or a refusal that carries a reason.
std::string Flaw(const absl::StatusOr<MeshFile>& result) {
  if (!result.ok()) {
    if (result.status().message().empty()) return "no message";
    return GetErrorReason(result.status()).has_value() ? "" : "no reason";
  }
  const auto vertices = static_cast<int>(result->mesh.positions.size());
  if (result->mesh.faces.empty()) return "no faces";
  for (const Eigen::Vector3i& face : result->mesh.faces) {
    if (face.minCoeff() < 0 || face.maxCoeff() >= vertices) return "corner out of range";
  }
  for (const Eigen::Vector3d& position : result->mesh.positions) {
    if (!position.allFinite()) return "coordinate not finite";
  }
  if (!CheckAttributes(result->mesh).ok()) return "attributes of the wrong size";
  const auto& source = result->face_source;
  if (!source.empty() && source.size() != result->mesh.faces.size()) return "wrong face_source";
  for (std::size_t i = 1; i < source.size(); ++i) {
    if (source[i] < source[i - 1]) return "face_source falls";
  }
  return "";
}

TEST(HostileInput, TheFilesAreValidToBeginWith) {
  for (const Sample& file : SmallFiles()) {
    const auto result = ReadMesh(file.bytes, file.format);
    EXPECT_TRUE(result.ok()) << file.name << ": " << result.status();
    EXPECT_EQ("", Flaw(result)) << file.name;
  }
}

TEST(HostileInput, EveryTruncation) {
  for (const Sample& file : SmallFiles()) {
    for (std::size_t size = 0; size < file.bytes.size(); ++size) {
      // A copy of its own size, so that a sanitizer sees every byte read past the end.
      const std::vector<char> cut(file.bytes.begin(),
                                  file.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      const auto result = ReadMesh({cut.data(), cut.size()}, file.format);
      EXPECT_EQ("", Flaw(result)) << file.name << " cut at " << size;
      // Text may lose its last line end, digits or faces; binary files may lose nothing.
      if (file.name.rfind("binary", 0) == 0) {
        EXPECT_FALSE(result.ok()) << file.name << " cut at " << size;
      }
    }
  }
}

TEST(HostileInput, DamagedBytes) {
  std::mt19937 random(2012);
  const std::vector<Sample> files = SmallFiles();
  for (int round = 0; round < 20000; ++round) {
    const Sample& file = files[static_cast<std::size_t>(round) % files.size()];
    std::string bytes = file.bytes;
    for (auto changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
          break;
        case 2:
          bytes[at] = "0123456789-+.e# \n\\/"[random() % 19];
          break;
        default:
          bytes.insert(at, 1 + random() % 3, '9');
      }
    }
    EXPECT_EQ("", Flaw(ReadMesh(bytes, file.format))) << file.name << ", round " << round;
  }
}

TEST(HostileInput, FilesOfOtherFormats) {
  const std::vector<Sample> files = SmallFiles();
  for (const Sample& file : files) {
    for (const Sample& other : files) {
      if (file.format == other.format) continue;
      const auto result = ReadMesh(file.bytes, other.format);
      EXPECT_FALSE(result.ok()) << file.name << " read as " << other.name;
      EXPECT_EQ("", Flaw(result)) << file.name << " read as " << other.name;
    }
  }
}

TEST(HostileInput, LongLinesTokensAndRuns) {
  const std::string digits(1 << 20, '9');
  const std::string spaces(1 << 20, ' ');
  std::string polygon = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int i = 0; i < 100000; ++i) polygon += " 1";
  for (const std::string& text :
       {"v " + digits + " 0 0\n", "f " + digits + "\n", "OFF\n" + digits + " 1 0\n",
        "OFF\n3 1 0\n" + spaces, "solid " + spaces + digits,
        "ply\nformat ascii 1.0\nelement " + digits, std::string(1 << 20, '\n'),
        std::string(1 << 20, '\\'), polygon}) {
    for (const MeshFormat format : {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly,
                                    MeshFormat::kStl, MeshFormat::kDraco}) {
      const auto result = ReadMesh(text, format);
      EXPECT_EQ("", Flaw(result));
      if (!result.ok()) {
        EXPECT_LT(result.status().message().size(), 500u);
      }
    }
  }
}

}  // namespace
}  // namespace ccst
