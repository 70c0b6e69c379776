// What results on real and on awkward models must hold beyond the floors: densities are followed
// and thin sheets are kept apart. Skipped where there are no models.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/io/image_file.h"
#include "core/io/mesh_file.h"
#include "core/io/whole_file.h"
#include "core/sampling/input/prepared_surface.h"
#include "core/sampling/sampling.h"
#include "core/spatial/hilbert.h"

namespace ccst {
namespace {

namespace fs = std::filesystem;

std::string MeshFolder() {
  const char* const set = std::getenv("CCST_MESHES");
  return set != nullptr ? set : std::string(CCST_SOURCE_DIR) + "/../shared/meshes";
}

class Models : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(MeshFolder())) {
      GTEST_SKIP() << "no test meshes in " << MeshFolder() << "; set CCST_MESHES";
    }
  }
};

TriangleMesh Read(const std::string& name) {
  return ReadMeshFile(MeshFolder() + "/" + name).value().mesh;
}

// The surface of a mesh that needs no repair, face by face, and the density that a run follows.
internal::PreparedSurface Prepared(const TriangleMesh& mesh, const SamplingOptions& options) {
  return *internal::Prepare(mesh, options, internal::Purpose::kMeasuring);
}

// Root mean square of the relative error of the share of samples, over `count` patches of about
// equal capacity: stretches of the faces along a Hilbert curve.
double ShareError(const TriangleMesh& mesh, const Density& density,
                  const std::vector<std::int32_t>& hosts, int count) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> order;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.positions) box.extend(p);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Eigen::Vector3d center =
        (mesh.positions[mesh.faces[f][0]] + mesh.positions[mesh.faces[f][1]] +
         mesh.positions[mesh.faces[f][2]]) /
        3.0;
    const Eigen::Vector3d unit = (center - box.min()) / box.sizes().maxCoeff() * 65535.0;
    order.emplace_back(
        HilbertIndex({static_cast<std::uint32_t>(unit[0]), static_cast<std::uint32_t>(unit[1]),
                      static_cast<std::uint32_t>(unit[2])}),
        static_cast<std::int32_t>(f));
  }
  std::sort(order.begin(), order.end());
  const std::vector<double>& capacities = density.face_capacities();
  const double total = std::accumulate(capacities.begin(), capacities.end(), 0.0);
  std::vector<double> share(count, 0.0);
  std::vector<int> patch(mesh.faces.size());
  double passed = 0.0;
  for (const auto& [key, f] : order) {
    patch[f] = std::min(count - 1, static_cast<int>(passed / total * count));
    passed += capacities[f];
    share[patch[f]] += capacities[f] / total;
  }
  std::vector<double> found(count, 0.0);
  for (const std::int32_t f : hosts) found[patch[f]] += 1.0 / static_cast<double>(hosts.size());
  double squares = 0.0;
  for (int i = 0; i < count; ++i) squares += std::pow(found[i] / share[i] - 1.0, 2);
  return std::sqrt(squares / count);
}

TEST_F(Models, CurvatureDensityIsFollowed) {
  for (const char* name : {"paper/bunny_6289.off", "paper/kitten_9756.off"}) {
    const TriangleMesh mesh = Read(name);
    SamplingOptions options;
    options.sample_count = 10000;
    options.density.source = DensitySource::kCurvature;
    const SamplingResult result = *SampleSurface(mesh, options);
    const Density density = Prepared(mesh, options).density;
    const double error = ShareError(mesh, density, result.samples.faces, 64);
    std::printf("%s: shares within %.1f %%, cv %.3f\n", name, 100.0 * error, result.capacity_cv);
    EXPECT_LE(error, 0.05) << name;
    EXPECT_LE(result.capacity_cv, 0.04) << name;
    // White noise is three times as far off: the measure tells.
    options.method = SamplingMethod::kWhiteNoise;
    EXPECT_GE(ShareError(mesh, density, SampleSurface(mesh, options)->samples.faces, 64), 0.06);
  }
}

TEST_F(Models, HalftoneFollowsTheTexture) {
  const TriangleMesh mesh = Read("textured/knot/texturedknot.ply");
  const std::string file = MeshFolder() + "/textured/knot/TextureDouble_A.png";
  SamplingOptions options;
  options.sample_count = 20000;
  options.density.source = DensitySource::kTexture;
  options.density.image =
      std::make_shared<const Image>(*DecodeImage(*io::ReadWholeFile(file, 1 << 24)));
  const SamplingResult result = *SampleSurface(mesh, options);

  // Both seen through the same blur, at points spread over the surface; what lies on the other
  // side of the tube is not seen. Evenly spread samples stand for the area.
  SamplingOptions uniform;
  uniform.sample_count = 60000;
  const SampleSet area = SampleSurface(mesh, uniform)->samples;
  const internal::PreparedSurface prepared = Prepared(mesh, options);
  const Surface& surface = prepared.surface;
  const Density& density = prepared.density;
  ASSERT_EQ(surface.face_count(), static_cast<std::int32_t>(mesh.faces.size()));
  const double radius = 3.0 * std::sqrt(result.surface.area / 20000.0);
  const double footprint = surface.area() / 20000.0;
  std::vector<double> seen;
  std::vector<double> wanted;
  for (int q = 0; q < 600; ++q) {
    const Eigen::Vector3d& eye = area.positions[97 * q];
    const Eigen::Vector3d& up = area.normals[97 * q];
    const auto weight = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
      const double d = (p - eye).squaredNorm() / (radius * radius);
      return d < 9.0 && normal.dot(up) > 0.0 ? std::exp(-0.5 * d) : 0.0;
    };
    double samples = 0.0;
    for (std::size_t i = 0; i < result.samples.positions.size(); ++i) {
      samples += weight(result.samples.positions[i], result.samples.normals[i]);
    }
    double mass = 0.0;
    double dark = 0.0;
    for (std::size_t i = 0; i < area.positions.size(); ++i) {
      const double w = weight(area.positions[i], area.normals[i]);
      if (w == 0.0) continue;
      const Eigen::Vector2d& b = area.barycentrics[i];
      mass += w;
      dark += w * density.At(area.faces[i], {b[0], b[1], 1.0 - b[0] - b[1]}, footprint);
    }
    seen.push_back(samples / mass);
    wanted.push_back(dark / mass);
  }
  const auto mean = [](const std::vector<double>& x) {
    return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  };
  const double a = mean(seen);
  const double b = mean(wanted);
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    ab += (seen[i] - a) * (wanted[i] - b);
    aa += (seen[i] - a) * (seen[i] - a);
    bb += (wanted[i] - b) * (wanted[i] - b);
  }
  std::printf("correlation %.4f, cv %.3f\n", ab / std::sqrt(aa * bb), result.capacity_cv);
  EXPECT_GE(ab / std::sqrt(aa * bb), 0.98);
}

// Triangles of the sample mesh whose corners lie on different sheets, by the hosts' places.
// `sheet` says which one a position is on, 0 where the sheets meet.
template <typename F>
int Jumps(const SamplingResult& result, F&& sheet) {
  int jumps = 0;
  for (const Eigen::Vector3i& t : result.samples.triangles) {
    bool first = false;
    bool second = false;
    for (int k = 0; k < 3; ++k) {
      const int side = sheet(result.samples.positions[t[k]]);
      first = first || side == 1;
      second = second || side == 2;
    }
    jumps += first && second;
  }
  return jumps;
}

TEST_F(Models, ThinSheetsStayApart) {
  for (const std::int64_t count : {500, 1000, 2000, 5000, 10000, 20000}) {
    SamplingOptions options;
    options.sample_count = count;
    const auto sample = [&](const char* name) {
      return *SampleSurface(Read(std::string("stress/") + name), options);
    };
    const auto spacing = [&](const SamplingResult& result) {
      return std::sqrt(result.surface.area / static_cast<double>(count));
    };
    const SamplingResult sheets = sample("two_sheets_gap_5e-3.off");
    EXPECT_EQ(Jumps(sheets, [](const auto& p) { return p.z() < 0.0025 ? 1 : 2; }), 0) << count;
    const SamplingResult spheres = sample("nested_spheres_gap_0.01.off");
    EXPECT_EQ(Jumps(spheres, [](const auto& p) { return p.norm() < 0.995 ? 1 : 2; }), 0) << count;
    // Near the bend one triangle may reach around.
    const SamplingResult hairpin = sample("hairpin_sheet_gap_0.02.off");
    const double bend = 1.0 - 2.0 * spacing(hairpin);
    EXPECT_EQ(
        Jumps(hairpin, [&](const auto& p) { return p.x() > bend   ? 0
                                                   : p.z() < 0.01 ? 1
                                                                  : 2; }), 0)
        << count;
  }
}

// Edges at which the faces turn by more than `angle` [rad].
std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> SharpEdges(
    const std::vector<Eigen::Vector3d>& positions, const std::vector<Eigen::Vector3i>& faces,
    double angle) {
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> normals;
  for (const Eigen::Vector3i& f : faces) {
    const Eigen::Vector3d normal =
        (positions[f[1]] - positions[f[0]]).cross(positions[f[2]] - positions[f[0]]).normalized();
    for (int k = 0; k < 3; ++k) normals[std::minmax(f[k], f[(k + 1) % 3])].push_back(normal);
  }
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> sharp;
  for (const auto& [edge, pair] : normals) {
    if (pair.size() != 2 || pair[0].dot(pair[1]) >= std::cos(angle)) continue;
    sharp.emplace_back(positions[edge.first], positions[edge.second]);
  }
  return sharp;
}

TEST_F(Models, CurvedCreasesAreFollowed) {
  for (const char* name : {"cad/fandisk.off", "cad/joint.off"}) {
    const TriangleMesh mesh = Read(name);
    SamplingOptions options;
    options.sample_count = 20000;
    options.crease_angle = 40.0 * M_PI / 180.0;
    const SamplingResult result = *SampleSurface(mesh, options);
    const auto lines =
        SharpEdges(result.samples.positions, result.samples.triangles, 25.0 * M_PI / 180.0);
    double farthest = 0.0;
    for (const auto& [a, b] : SharpEdges(mesh.positions, mesh.faces, *options.crease_angle)) {
      for (int step = 0; step <= 8; ++step) {
        const Eigen::Vector3d point = a + (b - a) * (step / 8.0);
        double nearest = result.surface.diagonal;
        for (const auto& [from, to] : lines) {
          const Eigen::Vector3d along = to - from;
          const double t = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
          nearest = std::min(nearest, (from + t * along - point).norm());
        }
        farthest = std::max(farthest, nearest);
      }
    }
    farthest /= result.surface.diagonal;
    std::printf("%s: creases within %.3f %% of the diagonal, cv %.3f, radius %.3f\n", name,
                100.0 * farthest, result.capacity_cv, result.relative_radius);
    EXPECT_LE(farthest, 1e-3) << name;
  }
}

}  // namespace
}  // namespace ccst
