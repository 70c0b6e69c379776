// Makes the seed corpus: fuzz_corpus FOLDER writes FOLDER/<target>/<input>.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "tests/support/shapes.h"

namespace {

namespace fs = std::filesystem;
namespace shapes = ccst::shapes;

class Corpus {
 public:
  explicit Corpus(fs::path folder) : folder_(std::move(folder)) {}

  void Add(const std::string& target, const std::string& name, const std::string& bytes) {
    fs::create_directories(folder_ / target);
    std::ofstream file(folder_ / target / name, std::ios::binary);
    file << bytes;
    if (!file.flush()) throw std::runtime_error("cannot write " + name);
  }

 private:
  fs::path folder_;
};

ccst::TriangleMesh WithAttributes(ccst::TriangleMesh mesh) {
  using ccst::AttributeKind;
  const auto values = [&mesh](std::size_t count) {
    std::vector<float> result(count * mesh.positions.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = 0.125f * static_cast<float>(i % 9);
    return result;
  };
  mesh.attributes = {
      {.name = "color", .kind = AttributeKind::kColor, .components = 4, .values = values(4)},
      {.name = "uv",
       .kind = AttributeKind::kTextureCoordinates,
       .components = 2,
       .values = values(2)},
      {.name = "heat", .values = values(1)},
      {.name = "flow", .components = 3, .values = values(3)}};
  return mesh;
}

/// Two triangles a hundred billion times as long as wide.
ccst::TriangleMesh Strip() { return shapes::PlaneGrid(1e9, 0.01, 1, 1); }

std::map<std::string, ccst::TriangleMesh> Meshes() {
  return {{"cube", shapes::Cube()},
          {"triangle", shapes::SingleTriangle()},
          {"sphere", shapes::Icosphere(1)},
          {"unwelded", shapes::Unwelded(shapes::Tetrahedron())},
          {"isolated", shapes::WithIsolatedVertices(shapes::Tetrahedron(), 3)},
          {"fins", shapes::ThreeFins()},
          {"touching", shapes::TetrahedraSharingVertex()},
          {"moebius", shapes::MoebiusStrip(12, 2)},
          {"strip", Strip()},
          {"pierced", shapes::SphereWithHole(0.8, 6, 8)},
          {"attributes", WithAttributes(shapes::Cube())},
          {"flipped", shapes::WithFlippedFace(shapes::Icosphere(1), 7)}};
}

void AddFiles(const std::string& name, const ccst::TriangleMesh& mesh, Corpus* corpus) {
  using ccst::MeshOutputFormat;
  const std::vector<MeshOutputFormat> formats = {MeshOutputFormat::kObj, MeshOutputFormat::kPly,
                                                 MeshOutputFormat::kStl, MeshOutputFormat::kOff,
                                                 MeshOutputFormat::kGlb};
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const auto bytes = ccst::EncodeMesh(mesh, formats[i]);
    if (!bytes.ok()) continue;
    corpus->Add("fuzz_readers", name + std::to_string(i), static_cast<char>(i) + *bytes);
  }
  for (const std::optional<int> bits : {std::optional<int>(), std::optional<int>(11)}) {
    const auto bytes = ccst::EncodeDraco(mesh, bits);
    if (bytes.ok()) corpus->Add("fuzz_draco", name + (bits.has_value() ? "-11" : ""), *bytes);
  }
}

/// What the writers do not write: other line ends, texture coordinates, ASCII, polygons.
void AddTexts(Corpus* corpus) {
  const auto add = [corpus](const char* name, int format, const char* text) {
    corpus->Add("fuzz_readers", name, static_cast<char>(format) + std::string(text));
  };
  add("obj-full", 0,
      "# all kinds\r\nmtllib a.mtl\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1e0 -0\r\n"
      "vt 0 0\r\nvt 1 1\r\nvn 0 0 1\r\ng part\r\nf 1/1/1 2/2/1 3//1 -1\r\nf 1 2 \\\n 3\r\n");
  add("ply-ascii", 1,
      "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
      "0 0 0 255\n1 0 0 0\n1 1 0 9\n0 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n4 0 1 2 3 0\n");
  add("ply-big-endian", 1,
      "ply\nformat binary_big_endian 1.0\nelement vertex 0\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list int int vertex_index\nend_header\n");
  add("stl-ascii", 2,
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid s\n");
  add("off-polygon", 3,
      "COFF # c\n5 1 0\n0 0 0 1 1 1 1\n1 0 0\n1 1 0\n0 1 0\n-1 .5 0\n5 0 1 2 3 4 7\n");
  add("off-all", 3,
      "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 9 .5 1\n1 0 0 0 0 1 0 1 0 0 .25\n0 1 0 0\n3 0 1 2\n");
  add("gltf", 4,
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],)"
      R"("nodes":[{"mesh":0,"children":[2]},{"mesh":0,"scale":[-1,2,1]},{"rotation":[0,0,1,0]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"_A":1,"_B":1,"COLOR_0":0}},)"
      R"({"mode":0,"attributes":{"POSITION":0}},{"attributes":{"POSITION":0,"TEXCOORD_0":2}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
      R"({"bufferView":0,"componentType":5121,"count":3,"type":"VEC4","normalized":true},)"
      R"({"bufferView":0,"byteOffset":4,"componentType":5122,"count":3,"type":"VEC2"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)"
      R"("uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
}

/// A glTF file whose primitive is compressed with Draco.
std::string CompressedGltf(const ccst::TriangleMesh& mesh) {
  const auto stream = ccst::EncodeDraco(mesh);
  if (!stream.ok()) throw std::runtime_error("cannot encode");
  return absl::StrCat(
      R"({"asset":{},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)",
      R"({"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,)",
      R"("attributes":{"POSITION":0,"COLOR_0":1,"TEXCOORD_0":2,"_HEAT":3,"_FLOW":4}}}}]}],)",
      R"("bufferViews":[{"buffer":0,"byteLength":)", stream->size(),
      R"(}],"buffers":[{"uri":"data:;base64,)", absl::Base64Escape(*stream), R"("}]})");
}

void AddRepairs(const std::string& name, const ccst::TriangleMesh& mesh, Corpus* corpus) {
  if (mesh.positions.size() > 255) return;
  for (int flags = 0; flags < 8; flags += 2) {
    std::string bytes(1, static_cast<char>(flags));
    if ((flags & 2) != 0) bytes += static_cast<char>(9);
    bytes += static_cast<char>(mesh.positions.size());
    for (const Eigen::Vector3d& p : mesh.positions) {
      for (int k = 0; k < 3; ++k) {
        bytes += static_cast<char>(static_cast<int>(std::clamp(40.0 * p[k], -128.0, 127.0)));
      }
    }
    for (const Eigen::Vector3i& face : mesh.faces) {
      for (const int v : face) bytes += static_cast<char>(v);
    }
    corpus->Add("fuzz_repair", name + std::to_string(flags), bytes);
  }
  std::string bytes(1, static_cast<char>(1));
  bytes += static_cast<char>(mesh.positions.size());
  for (const Eigen::Vector3d& p : mesh.positions) {
    bytes.append(reinterpret_cast<const char*>(p.data()), 3 * sizeof(double));
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int v : face) bytes += static_cast<char>(v);
  }
  corpus->Add("fuzz_repair", name + "-doubles", bytes);
}

void AddOptions(Corpus* corpus) {
  const std::vector<std::string> lines = {
      "sample\nbunny.obj\n--count\n5000\n-o\ns.ply\n--mesh-output\nm.obj\n--local\n--threads\n2",
      "sample\n-\n-n\n4\n--seed\n18446744073709551615\n--server\n[::1]:1\n--progress\njson",
      "sample\na.off\n--count=9\n--energy\nsquared-area\n--max-iterations\n0\n--tolerance\n1e-9",
      "sample\na.drc\n--count\n9\n--time-limit\n1.5\n--quantization-bits\n11\n--summary\n-",
      "sample\na.drc\n--count\n9\n--weld-tolerance\n0.5\n--picture\np.png",
      "info\n--json",
      "sample\n--help",
      "--version"};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    corpus->Add("fuzz_options", std::to_string(i), lines[i]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_corpus FOLDER\n");
    return 1;
  }
  try {
    Corpus corpus(argv[1]);
    for (const auto& [name, mesh] : Meshes()) {
      AddFiles(name, mesh, &corpus);
      AddRepairs(name, mesh, &corpus);
    }
    AddTexts(&corpus);
    corpus.Add("fuzz_readers", "gltf-draco",
               static_cast<char>(4) + CompressedGltf(WithAttributes(shapes::Tetrahedron())));
    AddOptions(&corpus);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
